// Fuzz targets of the program, by name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "tests/fuzz/cost_limit.h"
#include "tests/fuzz/fuzz_input.h"

namespace splatlas {

/// The seeds take at most 4 ms and 1.2 MiB. A quarter of a second allows for page faults and for tables that
/// are built at first use; 50 us per byte are 0.4 s for the longest input of scripts/fuzz.sh (8 KiB). Deflate
/// expands a byte to at most 1032, and a reader holds the bytes up to four times while it converts them:
/// 4 KiB per byte.
inline constexpr InputLimit kUsualLimit{.floor = {0.25, 8 << 20}, .per_byte = {50e-6, 4096}};

/// A target, in the list of the program from its construction on.
class FuzzTarget {
 public:
  /// `fuzz` aborts on a finding. `name` is that of its source NAME_fuzzer.cpp.
  FuzzTarget(std::string_view name, void (*fuzz)(FuzzInput), const InputLimit& limit = kUsualLimit);

  [[nodiscard]] std::string_view name() const { return name_; }
  /// An input within its limit.
  void run(const std::uint8_t* data, std::size_t size) const;

 private:
  std::string_view name_;
  void (*fuzz_)(FuzzInput);
  InputLimit limit_;
};

/// Null: there is none of this name.
[[nodiscard]] const FuzzTarget* find_target(std::string_view name);

}  // namespace splatlas
