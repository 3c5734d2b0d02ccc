// Tables of invalid files: the good atlas with one change per row, and the expected message.
#pragma once

#include <functional>
#include <string>

#include "tests/format/bad_files/raw_atlas.h"

namespace splatlas {

/// A change of one part of the good atlas.
template <typename Part>
struct BadFile {
  const char* what;
  void (*change)(Part& part);
  const char* message = "";  ///< takes the place of {} in the message of the table
};

/// A change and its message.
template <typename Part>
struct BadPart {
  void (*change)(Part& part);
  const char* message = "";
};

/// Ways to make the change of a row: in the directory, in a part of it, in the whole atlas.
inline constexpr auto in_directory = [](RawAtlas& a, const auto& row) { row.change(a.directory); };
inline constexpr auto in_part = [](auto part) {
  return [part](RawAtlas& a, const auto& row) { row.change(std::invoke(part, a.directory)); };
};
inline constexpr auto in_atlas = [](RawAtlas& a, const auto& row) { row.change(a); };

/// The message of opening or verifying a file of these bytes; "" for a valid one. The file name is F. Also
/// reads everything that can be read, which must do no harm. Expects the exit status of an invalid atlas.
[[nodiscard]] std::string fault_of_file(Bytes bytes);

/// Expects exactly this fault of an atlas: `message`, with `row_message` in place of {}. There, {0} to {3}
/// are the bytes of the good file, those of this one, and those of the good file less and plus 1.
void expect_fault(const RawAtlas& atlas, const char* message, const char* row_message, const char* what);

/// Expects the faults of a table; "" expects valid files. `apply(atlas, row)` makes the change of a row.
template <typename Row, std::size_t kRows, typename Apply>
void expect_faults(const Row (&rows)[kRows], const char* message, const Apply& apply) {
  for (const Row& row : rows) {
    RawAtlas atlas = raw_atlas(good_file());
    apply(atlas, row);
    if constexpr (requires { row.what; }) {
      expect_fault(atlas, message, row.message, row.what);
    } else {
      expect_fault(atlas, message, row.message, "");
    }
  }
}

}  // namespace splatlas
