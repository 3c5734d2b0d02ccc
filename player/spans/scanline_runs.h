// Runs of many classes, brought together scanline by scanline.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "format/run_model.h"
#include "format/system/thread_pool.h"

namespace splatlas {

/// One run of a class in its slice.
struct ClassRun {
  std::uint32_t row = 0, start = 0, length = 0;
  ClassId id = kEmptyClass;
};

/// The runs of all classes that have been inserted, for one principal axis, slice by slice, each by row, then
/// start. Selections are read off it in order: nothing is sorted when a selection changes.
class ScanlineRuns {
 public:
  /// Adds classes that are not there yet, each with its runs in traversal order; `rows` are those of a slice
  /// of the grid, the same in every call. Cost: linear in the new runs and in the runs of the slices that
  /// these lie in; slices are worked on in parallel. Not for use by several threads at once.
  void insert(std::span<const std::pair<ClassId, const ClassRuns*>> classes, std::int64_t rows,
              ThreadPool& pool);

  /// Of a slice of the grid; empty where nothing has been inserted.
  [[nodiscard]] std::span<const ClassRun> slice(std::int64_t n) const {
    if (n < first_ || n - first_ >= static_cast<std::int64_t>(slices_.size())) return {};
    return slices_[static_cast<std::size_t>(n - first_)];
  }

 private:
  void make_room(std::int64_t first, std::int64_t last);

  std::int64_t first_ = 0;  // slice of the grid that slices_ begins with
  std::vector<std::vector<ClassRun>> slices_;
};

}  // namespace splatlas
