// Voxels of one structure: a cropped class volume around it, or runs by row of the grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"

namespace splatlas {

/// A class inside a structure: Part::kInterior or Part::kBoundary.
struct StructureClass {
  ClassId id = kEmptyClass;
  Part part = Part::kInterior;
};

/// Memberships by structure. A lookup costs only the classes of one structure. Memory: 8 bytes per
/// membership. Construction: linear in the memberships.
class StructureClasses {
 public:
  /// All structures of memberships must be below `structures`.
  StructureClasses(const ClassTable& classes, std::size_t structures);

  /// Classes inside the structure in ascending order, without those that only its surface crosses.
  [[nodiscard]] std::span<const StructureClass> of(StructureIndex structure) const {
    return std::span(list_).subspan(first_[structure], first_[structure + 1] - first_[structure]);
  }

 private:
  std::vector<StructureClass> list_;
  std::vector<std::size_t> first_;  // [structure], size + 1 offsets
};

/// Bounding box of the voxels of these classes.
[[nodiscard]] IndexBox box_of(const ClassTable& classes, std::span<const StructureClass> members);

/// Parts of one structure in a box of voxels. The crop of a whole structure is its bounding box padded by one
/// voxel of outside, also beyond the grid.
struct StructureCrop {
  static constexpr std::uint8_t kOutside = 0, kInterior = 1, kBoundary = 2;

  Index3 first{0, 0, 0};  ///< grid index of the first voxel; -1 if the structure touches the border
  Index3 size{0, 0, 0};
  std::vector<std::uint8_t> parts;  ///< kOutside (also if only crossed), kInterior or kBoundary; i fastest

  [[nodiscard]] static std::uint8_t part_of(Part part) {
    return part == Part::kBoundary ? kBoundary : kInterior;
  }
  [[nodiscard]] std::size_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * size[1] + j) * size[0] + i);
  }
};

/// The voxels of a crop, padding included.
[[nodiscard]] inline IndexBox box_of(const StructureCrop& crop) {
  IndexBox box{crop.first, crop.first};
  for (std::size_t a = 0; a < 3; ++a) box.last[a] += crop.size[a] - 1;
  return box;
}

/// [class]: its part of the structure with classes `members`, for `classes` classes.
[[nodiscard]] std::vector<std::uint8_t> parts_of(std::span<const StructureClass> members,
                                                 std::size_t classes);

/// Runs of a class along z that are still to be visited, slice by slice of a crop of their structure.
struct RunsBySlice {
  ClassId id = kEmptyClass;
  std::span<const Run> left;

  /// Calls visit(i, j), in indices of the crop, for the voxels in its slice k. Slices come in order. `rows`
  /// are those of a slice of the grid.
  template <typename Visit>
  void visit_slice(std::int64_t k, const StructureCrop& crop, std::int64_t rows, const Visit& visit) {
    for (; !left.empty(); left = left.subspan(1)) {
      const auto scanline = static_cast<std::int64_t>(left.front().scanline);
      if (scanline / rows != k + crop.first[2]) return;
      const std::int64_t i = left.front().start - crop.first[0], j = scanline % rows - crop.first[1];
      for (std::int64_t n = 0; n < left.front().length; ++n) visit(i + n, j);
    }
  }
};

/// The crop of a structure with voxels in `box`, from the runs of its classes `members` along z.
[[nodiscard]] StructureCrop crop_structure(const RunModel& runs, std::int64_t rows, const IndexBox& box,
                                           std::span<const StructureClass> members);

/// A crop of `box`, padded by one voxel, with all voxels outside. Fill it with paint_runs().
[[nodiscard]] StructureCrop empty_crop(const IndexBox& box);
/// Paints runs (principal axis z, valid in a grid with `rows` rows per slice), clipped to the crop.
void paint_runs(std::span<const Run> runs, std::int64_t rows, std::uint8_t part, StructureCrop& crop);

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
