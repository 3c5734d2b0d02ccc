// Runs of one structure, by row of the grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/run_model.h"

namespace splatlas {

/// Voxels [start, end) of a row, in one part of the structure (StructureCrop::kInterior or kBoundary).
struct PartRun {
  std::int64_t start = 0, end = 0;
  std::uint8_t part = 0;
};

/// The voxels of one structure as sorted runs (principal axis z). Memory: 24 bytes per run and per row.
/// Before and in sort(), up to kMaxBytesPerRun.
class PartRows {
 public:
  /// Bytes per run: placed runs of doubled capacity, and sorted runs and rows.
  static constexpr double kMaxBytesPerRun = 112;

  explicit PartRows(const Index3& size) : size_(size) {}

  /// Adds runs that are valid in the grid. sort() must follow.
  void add(std::span<const Run> runs, std::uint8_t part);
  void sort();

  struct Row {
    std::int64_t j = 0, k = 0;
    std::size_t first_run = 0;
  };
  /// Rows with runs, in memory order.
  [[nodiscard]] std::span<const Row> rows() const { return rows_; }
  /// The runs of a row, disjoint and in order; empty outside the grid. Cost: logarithmic in the rows.
  [[nodiscard]] std::span<const PartRun> row(std::int64_t j, std::int64_t k) const;
  [[nodiscard]] const Index3& size() const { return size_; }

 private:
  struct PlacedRun {
    std::uint64_t scanline = 0;
    PartRun run;
  };
  Index3 size_;
  std::vector<PlacedRun> placed_;  // until sort()
  std::vector<PartRun> runs_;
  std::vector<Row> rows_;
};

}  // namespace splatlas
