// Runs of all decoded classes, merged by scanline.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "format/content/run_model.h"
#include "format/tasks/thread_pool.h"

namespace splatlas {

/// A run of a class within a slice.
struct ClassRun {
  std::uint32_t row = 0, start = 0, length = 0;
  ClassId id = kEmptyClass;
};

/// The runs of all inserted classes for one principal axis, by slice, row and start. A change of selection
/// needs no sorting: traversal filters the runs in order. Slices without runs take neither memory nor time.
class ScanlineRuns {
 public:
  /// Adds new classes, each with its runs in traversal order. `rows` is the number of rows of a slice of the
  /// grid, the same in every call. Cost: linear in the new runs and in the existing runs of their slices,
  /// which are merged in parallel. Not thread-safe. Throws std::bad_alloc.
  void insert(std::span<const std::pair<ClassId, const ClassRuns*>> classes, std::int64_t rows,
              ThreadPool& pool);

  /// The runs of a slice of the grid; empty for slices without insertions. Cost: logarithmic in the slices.
  [[nodiscard]] std::span<const ClassRun> slice(std::int64_t n) const;
  /// Numbers of the slices with runs from `first` to `last`, inclusive, ascending.
  [[nodiscard]] std::span<const std::int64_t> occupied(std::int64_t first, std::int64_t last) const;

 private:
  void make_room(std::span<const std::int64_t> numbers);

  std::vector<std::int64_t> numbers_;          // of slices with runs, ascending
  std::vector<std::vector<ClassRun>> slices_;  // [index into numbers_]
};

}  // namespace splatlas
