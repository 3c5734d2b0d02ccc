// Work budget: counted work of an operation on an atlas, and its limit for a file of given size.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// Quantities that follow from the directory of an atlas before any chunk is read.
enum class WorkKind : std::uint8_t {
  kBytes,      ///< decoded from chunks
  kRuns,       ///< decoded or derived
  kVoxels,     ///< decoded, fitted, drawn or written one by one
  kTriangles,  ///< decoded, fitted or drawn
  kRows,       ///< of tables of slices and bricks
  kPixels,     ///< of sheets finer than the picture
};
inline constexpr std::size_t kWorkKinds = 6;

/// Counted work. One unit is about one nanosecond of one core, or a quarter of a nanosecond per byte of
/// memory that the operation holds at once, whichever is more. Counts saturate as double.
class Work {
 public:
  /// Adds `count` items of `units_each` units.
  void add(WorkKind kind, double count, double units_each);
  /// Raises the memory that a single step of the operation holds at once.
  void hold(double bytes);
  Work& operator+=(const Work& other);

  [[nodiscard]] double units() const;
  /// Counts of the kind with the most units: "4.1e+09 decoded bytes".
  [[nodiscard]] std::string largest() const;

 private:
  std::array<double, kWorkKinds> counts_{}, units_{};
  double held_bytes_ = 0;
};

/// Limit of work for one file. A small file is refused if it takes long: a real atlas of its size does not.
class WorkBudget {
 public:
  /// `max_work` scales the limit; at least 1.
  WorkBudget(std::string file_name, std::uint64_t file_bytes, double max_work);

  /// Units allowed: 8e8 (about a second) for files up to 1 MiB, and 10 000 for each further byte.
  [[nodiscard]] double allowed() const;
  /// kLimit if the work exceeds the budget; the message has the numbers and the option --max-work that allows
  /// it. `purpose` names the operation: "the selection".
  [[nodiscard]] Result<void> check(const Work& work, std::string_view purpose) const;

 private:
  std::string file_name_;
  std::uint64_t file_bytes_;
  double max_work_;
};

}  // namespace splatlas
