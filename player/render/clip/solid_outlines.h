// Outlines of solids in a cutting plane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/surface.h"
#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_rays.h"

namespace splatlas {

/// Points of a plane inside surfaces, by winding numbers. Immutable and thread-safe. Memory and cost follow
/// the triangles that the plane crosses.
class SolidOutlines {
 public:
  /// No solid.
  static constexpr std::uint32_t kNone = 0xffffffff;

  SolidOutlines() = default;
  /// Slices the surfaces of solids. Points of the plane are given by their continuous voxel indices along the
  /// axes `b` and `c`; the plane's normal is not perpendicular to the third axis. Where solids overlap, the
  /// later one wins. Solids without a closed outline enclose nothing; see is_closed().
  SolidOutlines(const VoxelPlane& plane, std::size_t b, std::size_t c,
                std::span<const SurfaceMesh* const> solids, ThreadPool& pool);

  /// False if a surface crosses the plane in open lines.
  [[nodiscard]] bool is_closed(std::uint32_t solid) const { return closed_[solid]; }
  /// A unit square of the plane.
  struct Cell {
    std::int32_t cell = 0, row = 0;  // of its first corner, along b and c
    std::uint32_t base = kNone;      // last solid that encloses all of it, without those of the pieces
    std::uint32_t first_piece = 0, pieces = 0;
  };
  /// The square with these numbers along `b` and `c`. O(log segments).
  [[nodiscard]] Cell cell(std::int64_t b, std::int64_t c) const;
  /// The last solid that encloses a point of a square; kNone if there is none. O(1) away from outlines.
  [[nodiscard]] std::uint32_t at(const Cell& cell, double b, double c) const;

 private:
  /// Crossing of a triangle by the plane. The solid is on the left.
  struct Segment {
    std::array<double, 2> from, to;
  };
  /// A solid whose outline passes through a cell.
  struct Piece {
    std::uint32_t solid;
    std::int32_t winding;           // at the anchor of the cell
    std::uint32_t first, segments;  // in cell_segments_
  };
  /// Cells of a row from `first` to the next interval: all the same, or a single one with pieces.
  struct Interval {
    std::int32_t first;
    std::uint32_t base;                 // last solid that encloses all of them, without those of `pieces`
    std::uint32_t first_piece, pieces;  // in pieces_
  };
  struct Row {
    std::int32_t number;
    std::uint32_t first, intervals;  // in intervals_
  };
  /// A segment that passes through a cell.
  struct CellSegment {
    std::int32_t row, cell;
    std::uint32_t solid, segment;
    friend auto operator<=>(const CellSegment&, const CellSegment&) = default;
  };
  class RowBuilder;

  [[nodiscard]] static std::vector<Segment> slice(const SurfaceMesh& mesh, const VoxelPlane& plane,
                                                  std::size_t b, std::size_t c);

  std::vector<Segment> segments_;
  std::vector<std::uint32_t> cell_segments_;
  std::vector<Piece> pieces_;
  std::vector<Interval> intervals_;
  std::vector<Row> rows_;
  std::vector<bool> closed_;
};

}  // namespace splatlas
