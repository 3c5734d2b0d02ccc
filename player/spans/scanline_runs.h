// Runs of all decoded classes, merged by scanline.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "format/run_model.h"
#include "format/system/thread_pool.h"

namespace splatlas {

/// A run of a class within a slice.
struct ClassRun {
  std::uint32_t row = 0, start = 0, length = 0;
  ClassId id = kEmptyClass;
};

/// The runs of all inserted classes for one principal axis, by slice, row and start. A change of selection
/// needs no sorting: traversal filters the runs in order.
class ScanlineRuns {
 public:
  /// Adds new classes, each with its runs in traversal order. `rows` is the number of rows of a slice of the
  /// grid, the same in every call. Cost: linear in the new runs and in the existing runs of their slices,
  /// which are merged in parallel. Not thread-safe. Throws std::bad_alloc.
  void insert(std::span<const std::pair<ClassId, const ClassRuns*>> classes, std::int64_t rows,
              ThreadPool& pool);

  /// The runs of a slice of the grid; empty for slices without insertions.
  [[nodiscard]] std::span<const ClassRun> slice(std::int64_t n) const {
    if (n < first_ || n - first_ >= static_cast<std::int64_t>(slices_.size())) return {};
    return slices_[static_cast<std::size_t>(n - first_)];
  }

 private:
  void make_room(std::int64_t first, std::int64_t last);

  std::int64_t first_ = 0;  // slice of the grid of slices_[0]
  std::vector<std::vector<ClassRun>> slices_;
};

}  // namespace splatlas
