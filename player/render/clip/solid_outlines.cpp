#include "player/render/clip/solid_outlines.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace splatlas {
namespace {

/// Distance in cells from which a segment counts as passing through a cell.
constexpr double kSlack = 1e-9;

using Point = std::array<double, 2>;

/// Point of each cell with winding numbers. Outlines run along halves and integers, and must not hold it.
constexpr Point kAnchor{0.41421356237, 0.23606797750};

/// Position of `p` relative to the line from `origin` along `direction`: positive on its left.
double side_of(const Point& direction, const Point& origin, const Point& p) {
  return direction[0] * (p[1] - origin[1]) - direction[1] * (p[0] - origin[0]);
}

Point between(const Point& from, const Point& to) {
  return {to[0] - from[0], to[1] - from[1]};
}

/// Change of the winding number on the way between two points across a line from `a` to `b`.
int winding_across(const Point& from, const Point& to, const Point& a, const Point& b) {
  const Point way = between(from, to), line = between(a, b);
  const bool a_is_left = side_of(way, from, a) > 0, b_is_left = side_of(way, from, b) > 0;
  if (a_is_left == b_is_left) return 0;
  if ((side_of(line, a, from) > 0) == (side_of(line, a, to) > 0)) return 0;
  return b_is_left ? 1 : -1;
}

/// Calls visit(row, cell) for the cells that a segment passes through.
template <typename Visit>
void for_each_cell(const Point& from, const Point& to, const Visit& visit) {
  const double low = std::min(from[1], to[1]), high = std::max(from[1], to[1]);
  const bool is_flat = high - low < kSlack;
  const auto at = [&](double c) {
    const double t = (std::clamp(c, low, high) - from[1]) / (to[1] - from[1]);
    return from[0] + t * (to[0] - from[0]);
  };
  const auto last_row = static_cast<std::int32_t>(std::floor(high + kSlack));
  for (auto row = static_cast<std::int32_t>(std::floor(low - kSlack)); row <= last_row; ++row) {
    const double one = is_flat ? from[0] : at(row - kSlack), other = is_flat ? to[0] : at(row + 1 + kSlack);
    const auto last_cell = static_cast<std::int32_t>(std::floor(std::max(one, other) + kSlack));
    for (auto cell = static_cast<std::int32_t>(std::floor(std::min(one, other) - kSlack)); cell <= last_cell;
         ++cell)
      visit(row, cell);
  }
}

/// Hash of a point (finaliser of MurmurHash3).
std::uint64_t hash_of(const Point& p) {
  std::uint64_t h =
      std::bit_cast<std::uint64_t>(p[0]) * 0x9e3779b97f4a7c15u ^ std::bit_cast<std::uint64_t>(p[1]);
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
  return h ^ (h >> 33);
}

}  // namespace

std::vector<SolidOutlines::Segment> SolidOutlines::slice(const SurfaceMesh& mesh, const VoxelPlane& plane,
                                                         std::size_t b, std::size_t c) {
  std::vector<double> distances(mesh.positions_ijk.size());
  for (std::size_t n = 0; n < distances.size(); ++n) {
    const auto& p = mesh.positions_ijk[n];
    distances[n] = plane.distance({p[0], p[1], p[2]});
  }
  // An edge begins at its smaller position: triangles that share no vertices then have the same crossing
  const auto crossing = [&](std::uint32_t one, std::uint32_t other) {
    if (mesh.positions_ijk[other] < mesh.positions_ijk[one]) std::swap(one, other);
    const double t = distances[one] / (distances[one] - distances[other]);
    const auto &p = mesh.positions_ijk[one], &q = mesh.positions_ijk[other];
    const auto along = [&](std::size_t axis) {
      const double from = p[axis];
      return from + t * (static_cast<double>(q[axis]) - from);
    };
    return Point{along(b), along(c)};
  };
  std::vector<Segment> segments;
  for (const auto& triangle : mesh.triangles) {
    const std::array<bool, 3> above{distances[triangle[0]] > 0, distances[triangle[1]] > 0,
                                    distances[triangle[2]] > 0};
    if (above[0] == above[1] && above[1] == above[2]) continue;
    // Find the corner on its own side
    const std::size_t own = above[1] == above[2] ? 0 : above[0] == above[2] ? 1 : 2;
    const std::uint32_t corner = triangle[own], next = triangle[(own + 1) % 3],
                        last = triangle[(own + 2) % 3];
    Segment segment{crossing(corner, next), crossing(corner, last)};
    if (above[own]) std::swap(segment.from, segment.to);
    if (segment.from != segment.to) segments.push_back(segment);
  }
  return segments;
}

/// Sorts the segments of one row of cells into intervals.
class SolidOutlines::RowBuilder {
 public:
  explicit RowBuilder(SolidOutlines& outlines) : outlines_(outlines) {}

  void add(std::span<const CellSegment> segments) {
    const std::int32_t row = segments.front().row;
    const auto first = static_cast<std::uint32_t>(outlines_.intervals_.size());
    find_crossings(segments, row + kAnchor[1]);
    active_.clear();
    std::size_t next_crossing = 0;
    for (std::size_t n = 0; n < segments.size();) {
      const std::int32_t cell = segments[n].cell;
      std::size_t end = n;
      while (end < segments.size() && segments[end].cell == cell) ++end;
      pass_crossings(next_crossing, cell);
      add_cell(segments.subspan(n, end - n), next_crossing);
      if (end == segments.size() || segments[end].cell > cell + 1) {
        pass_crossings(next_crossing, end == segments.size() ? HUGE_VAL : cell + 1);
        outlines_.intervals_.push_back({cell + 1, base_without({}), 0, 0});
      }
      n = end;
    }
    const auto intervals = static_cast<std::uint32_t>(outlines_.intervals_.size()) - first;
    outlines_.rows_.push_back({row, first, intervals});
  }

 private:
  struct RowCrossing {
    double at;
    std::uint32_t solid;
    int winding;
  };
  struct Winding {
    std::uint32_t solid;
    std::int32_t winding;
  };

  /// Crossings of the line through the cells' anchors.
  void find_crossings(std::span<const CellSegment> segments, double c) {
    seen_.clear();
    for (const CellSegment& one : segments) seen_.push_back({one.segment, one.solid});
    std::ranges::sort(seen_);
    seen_.erase(std::unique(seen_.begin(), seen_.end()), seen_.end());
    crossings_.clear();
    for (const auto& [segment, solid] : seen_) {
      const auto& [from, to] = outlines_.segments_[segment];
      if ((from[1] > c) == (to[1] > c)) continue;
      const double t = (c - from[1]) / (to[1] - from[1]);
      crossings_.push_back({from[0] + t * (to[0] - from[0]), solid, to[1] > c ? 1 : -1});
    }
    std::ranges::sort(crossings_, {}, &RowCrossing::at);
  }

  void pass_crossings(std::size_t& next, double before) {
    for (; next < crossings_.size() && crossings_[next].at < before; ++next) {
      const RowCrossing& crossing = crossings_[next];
      const auto known = std::ranges::find(active_, crossing.solid, &Winding::solid);
      if (known == active_.end()) {
        active_.push_back({crossing.solid, crossing.winding});
      } else if ((known->winding += crossing.winding) == 0) {
        active_.erase(known);
      }
    }
  }

  [[nodiscard]] std::int32_t winding_of(std::uint32_t solid) const {
    const auto known = std::ranges::find(active_, solid, &Winding::solid);
    return known == active_.end() ? 0 : known->winding;
  }

  /// The last active solid without pieces among `pieces`.
  [[nodiscard]] std::uint32_t base_without(std::span<const Piece> pieces) const {
    std::uint32_t base = kNone;
    for (const auto& [solid, winding] : active_) {
      if ((base == kNone || solid > base) && std::ranges::find(pieces, solid, &Piece::solid) == pieces.end())
        base = solid;
    }
    return base;
  }

  void add_cell(std::span<const CellSegment> segments, std::size_t next_crossing) {
    const std::int32_t cell = segments.front().cell;
    const auto first_piece = static_cast<std::uint32_t>(outlines_.pieces_.size());
    for (std::size_t n = 0; n < segments.size();) {
      const std::uint32_t solid = segments[n].solid;
      Piece piece{solid, winding_of(solid), static_cast<std::uint32_t>(outlines_.cell_segments_.size()), 0};
      for (std::size_t k = next_crossing; k < crossings_.size() && crossings_[k].at < cell + kAnchor[0];
           ++k) {
        if (crossings_[k].solid == solid) piece.winding += crossings_[k].winding;
      }
      for (; n < segments.size() && segments[n].solid == solid; ++n, ++piece.segments)
        outlines_.cell_segments_.push_back(segments[n].segment);
      outlines_.pieces_.push_back(piece);
    }
    const auto pieces = static_cast<std::uint32_t>(outlines_.pieces_.size()) - first_piece;
    const std::uint32_t base = base_without(std::span(outlines_.pieces_).subspan(first_piece));
    outlines_.intervals_.push_back({cell, base, first_piece, pieces});
  }

  SolidOutlines& outlines_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> seen_;  // segments and their solids
  std::vector<RowCrossing> crossings_;
  std::vector<Winding> active_;  // solids with a winding number other than 0
};

SolidOutlines::SolidOutlines(const VoxelPlane& plane, std::size_t b, std::size_t c,
                             std::span<const SurfaceMesh* const> solids, ThreadPool& pool) {
  // Slice the surfaces
  std::vector<std::vector<Segment>> of_solids(solids.size());
  pool.for_each(solids.size(), [&](std::size_t n) { of_solids[n] = slice(*solids[n], plane, b, c); });
  closed_.resize(solids.size());
  std::vector<CellSegment> cells;
  for (std::uint32_t solid = 0; solid < solids.size(); ++solid) {
    std::uint64_t ends = 0;
    for (const Segment& segment : of_solids[solid]) ends += hash_of(segment.to) - hash_of(segment.from);
    closed_[solid] = ends == 0;
    if (!closed_[solid]) continue;
    for (const Segment& segment : of_solids[solid]) {
      const auto number = static_cast<std::uint32_t>(segments_.size());
      segments_.push_back(segment);
      for_each_cell(segment.from, segment.to, [&](std::int32_t row, std::int32_t cell) {
        cells.push_back({row, cell, solid, number});
      });
    }
  }

  // Sort them into rows
  std::ranges::sort(cells);
  RowBuilder builder(*this);
  for (auto first = cells.begin(); first != cells.end();) {
    const auto end =
        std::find_if(first, cells.end(), [&](const CellSegment& one) { return one.row != first->row; });
    builder.add(std::span(&*first, static_cast<std::size_t>(end - first)));
    first = end;
  }
}

SolidOutlines::Cell SolidOutlines::cell(std::int64_t b, std::int64_t c) const {
  Cell cell{static_cast<std::int32_t>(b), static_cast<std::int32_t>(c)};
  const auto row = std::ranges::lower_bound(rows_, cell.row, {}, &Row::number);
  if (row == rows_.end() || row->number != cell.row) return cell;
  const auto intervals = std::span(intervals_).subspan(row->first, row->intervals);
  const auto next = std::ranges::upper_bound(intervals, cell.cell, {}, &Interval::first);
  if (next == intervals.begin()) return cell;
  const Interval& interval = *std::prev(next);
  return {cell.cell, cell.row, interval.base, interval.first_piece, interval.pieces};
}

std::uint32_t SolidOutlines::at(const Cell& cell, double b, double c) const {
  std::uint32_t last = cell.base;
  for (const Piece& piece : std::span(pieces_).subspan(cell.first_piece, cell.pieces)) {
    if (last != kNone && piece.solid < last) continue;
    std::int32_t winding = piece.winding;
    const Point anchor{cell.cell + kAnchor[0], cell.row + kAnchor[1]};
    for (const std::uint32_t n : std::span(cell_segments_).subspan(piece.first, piece.segments))
      winding += winding_across(anchor, {b, c}, segments_[n].from, segments_[n].to);
    if (winding != 0) last = piece.solid;
  }
  return last;
}

}  // namespace splatlas
