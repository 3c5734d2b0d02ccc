#include "format/derive/marching_cubes.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <utility>

#include "format/system/task_control.h"

namespace splatlas {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

// Case table

constexpr std::size_t kEdges = 12, kMaxTriangles = 10;

/// Edge number: by axis, then by corner.
constexpr std::size_t number_of(const CellEdge& edge) {
  const auto above = static_cast<std::size_t>(edge.corner >> (edge.axis + 1));
  const auto below = edge.corner & ((1u << edge.axis) - 1);
  return edge.axis * std::size_t{4} + (above << edge.axis) + below;
}
constexpr CellEdge edge_between(unsigned a, unsigned b) {
  const unsigned bit = a ^ b;
  return {static_cast<std::uint8_t>(a & b), static_cast<std::uint8_t>(bit == 1 ? 0 : bit == 2 ? 1 : 2)};
}

struct CellCase {
  std::array<std::array<CellEdge, 3>, kMaxTriangles> triangles{};
  std::size_t count = 0;
};

/// Corners of a face, counter-clockwise seen from outside the cell.
constexpr std::array<unsigned, 4> face_corners(unsigned axis, bool far_side) {
  const unsigned b = 1u << (axis + 1) % 3, c = 1u << (axis + 2) % 3, at = far_side ? 1u << axis : 0;
  return far_side ? std::array<unsigned, 4>{at, at | b, at | b | c, at | c}
                  : std::array<unsigned, 4>{at, at | c, at | b | c, at | b};
}

struct Loop {
  std::array<CellEdge, kEdges> edges{};
  std::size_t count = 0;

  [[nodiscard]] constexpr std::array<CellEdge, 3> triangle(std::size_t start, std::size_t n) const {
    return {edges[start], edges[(start + n + 1) % count], edges[(start + n + 2) % count]};
  }
};

/// True if all three vertices are in one face of the cell.
constexpr bool lies_in_a_face(const std::array<CellEdge, 3>& triangle) {
  for (unsigned axis = 0; axis < 3; ++axis) {
    for (unsigned side = 0; side < 2; ++side) {
      bool all = true;
      for (const CellEdge& edge : triangle)
        all = all && edge.axis != axis && (edge.corner >> axis & 1) == side;
      if (all) return true;
    }
  }
  return false;
}

/// Triangulates a loop as a fan. Avoids triangles in a face of the cell: the neighbouring cell could contain
/// them, too.
constexpr void add_fan(const Loop& loop, CellCase& result) {
  const auto fits = [&](std::size_t start) {
    for (std::size_t n = 0; n + 2 < loop.count; ++n) {
      if (lies_in_a_face(loop.triangle(start, n))) return false;
    }
    return true;
  };
  std::size_t start = 0;
  while (start < loop.count && !fits(start)) ++start;
  if (start == loop.count) start = 0;
  for (std::size_t n = 0; n + 2 < loop.count; ++n) result.triangles[result.count++] = loop.triangle(start, n);
}

constexpr CellCase make_case(unsigned inside) {
  const auto is_inside = [&](unsigned corner) { return (inside >> corner & 1) != 0; };
  // Successor of each edge in its loop, or kEdges.
  std::array<std::size_t, kEdges> next{};
  std::array<CellEdge, kEdges> edges{};
  next.fill(kEdges);
  for (unsigned face = 0; face < 6; ++face) {
    const std::array<unsigned, 4> corners = face_corners(face / 2, face % 2 == 1);
    for (unsigned n = 0; n < 4; ++n) {
      if (is_inside(corners[n]) || !is_inside(corners[(n + 1) % 4])) continue;
      // Find the end of the chain of inside corners that begins here.
      unsigned last = n + 1;
      while (is_inside(corners[(last + 1) % 4])) ++last;
      const CellEdge enters = edge_between(corners[n], corners[(n + 1) % 4]);
      const CellEdge leaves = edge_between(corners[last % 4], corners[(last + 1) % 4]);
      next[number_of(enters)] = number_of(leaves);
      edges[number_of(enters)] = enters;
    }
  }
  CellCase result;
  for (std::size_t first = 0; first < kEdges; ++first) {
    if (next[first] == kEdges) continue;
    Loop loop;
    for (std::size_t edge = first; next[edge] != kEdges; edge = std::exchange(next[edge], kEdges))
      loop.edges[loop.count++] = edges[edge];
    add_fan(loop, result);
  }
  return result;
}

constexpr std::array<CellCase, 256> make_cases() {
  std::array<CellCase, 256> cases{};
  for (unsigned inside = 0; inside < 256; ++inside) cases[inside] = make_case(inside);
  return cases;
}
const std::array<CellCase, 256> kCases = make_cases();

// Surface extraction

/// A cell with triangles, with the leading voxel by which triangles are sorted.
struct LedCell {
  std::int64_t leading = 0;  ///< offset in the crop
  std::uint32_t first_triangle = 0, triangles = 0;
};

/// Traverses the cells layer by layer and collects vertices and triangles.
class CellWalker {
 public:
  explicit CellWalker(const StructureCrop& crop) : crop_(crop) {
    const auto slice = static_cast<std::size_t>(crop.size[0] * crop.size[1]);
    for (auto& edges_of_axis : edges_) {
      for (LayerEdges& edges : edges_of_axis) edges.vertices.assign(slice, kNone);
    }
  }

  void walk() {
    for (std::int64_t k = 0; k + 1 < crop_.size[2]; ++k) {
      check_cancelled();
      for (std::int64_t j = 0; j + 1 < crop_.size[1]; ++j) walk_row(j, k);
      go_to_next_layer();
    }
  }

  SurfaceMesh surface;
  std::vector<LedCell> cells;

 private:
  void walk_row(std::int64_t j, std::int64_t k) {
    const std::array<const std::uint8_t*, 4> rows{
        &crop_.parts[crop_.offset(0, j, k)], &crop_.parts[crop_.offset(0, j + 1, k)],
        &crop_.parts[crop_.offset(0, j, k + 1)], &crop_.parts[crop_.offset(0, j + 1, k + 1)]};
    const auto column = [&](std::int64_t i) {
      unsigned bits = 0;
      for (unsigned row = 0; row < 4; ++row) bits |= unsigned{rows[row][i] != 0} << (2 * row);
      return bits;
    };
    const auto all_are = [&](std::int64_t first, std::uint64_t eight_voxels) {
      return std::ranges::all_of(rows, [&](const std::uint8_t* row) {
        std::uint64_t voxels = 0;
        std::memcpy(&voxels, row + first, sizeof voxels);
        return voxels == eight_voxels;
      });
    };
    constexpr unsigned kAllInside = 0b01010101;
    constexpr std::uint64_t kEightInterior = 0x0101010101010101 * StructureCrop::kInterior;
    unsigned before = column(0);
    for (std::int64_t i = 0; i + 1 < crop_.size[0];) {
      // Skip eight cells without a surface.
      if (i + 8 < crop_.size[0] &&
          ((before == 0 && all_are(i + 1, 0)) || (before == kAllInside && all_are(i + 1, kEightInterior)))) {
        i += 8;
        continue;
      }
      const unsigned after = column(i + 1), inside = before | after << 1;
      before = after;
      if (inside != 0 && inside != 255) add_cell(i, j, k, inside);
      ++i;
    }
  }

  /// The upper slice of a layer is the lower slice of the next.
  void go_to_next_layer() {
    const auto clear = [](LayerEdges& edges) {
      if (edges.used) std::ranges::fill(edges.vertices, kNone);
      edges.used = false;
    };
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::swap(edges_[axis][0], edges_[axis][1]);
      clear(edges_[axis][1]);
    }
    clear(edges_[2][0]);
  }

  void add_cell(std::int64_t i, std::int64_t j, std::int64_t k, unsigned inside) {
    const CellCase& cell = kCases[inside];
    cells.push_back({leading_voxel(i, j, k), static_cast<std::uint32_t>(surface.triangles.size()),
                     static_cast<std::uint32_t>(cell.count)});
    for (std::size_t t = 0; t < cell.count; ++t) {
      std::array<std::uint32_t, 3>& triangle = surface.triangles.emplace_back();
      for (std::size_t n = 0; n < 3; ++n) triangle[n] = vertex_at(i, j, k, cell.triangles[t][n]);
    }
  }

  [[nodiscard]] std::int64_t leading_voxel(std::int64_t i, std::int64_t j, std::int64_t k) const {
    for (unsigned corner = 0; corner < 8; ++corner) {  // in ascending memory order
      const std::size_t at = crop_.offset(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
      if (crop_.parts[at] == StructureCrop::kBoundary) return static_cast<std::int64_t>(at);
    }
    return 0;  // unreachable: a cell with a triangle has an inside voxel next to an outside voxel
  }

  std::uint32_t vertex_at(std::int64_t i, std::int64_t j, std::int64_t k, const CellEdge& edge) {
    const std::int64_t x = i + (edge.corner & 1), y = j + (edge.corner >> 1 & 1);
    const unsigned above = edge.corner >> 2;
    LayerEdges& edges = edges_[edge.axis][above];
    std::uint32_t& vertex = edges.vertices[static_cast<std::size_t>(y * crop_.size[0] + x)];
    if (vertex == kNone) {
      edges.used = true;
      vertex = static_cast<std::uint32_t>(surface.positions_ijk.size());
      const Index3 at{x + crop_.first[0], y + crop_.first[1], k + above + crop_.first[2]};
      std::array<float, 3>& position = surface.positions_ijk.emplace_back();
      for (std::size_t a = 0; a < 3; ++a)
        position[a] = static_cast<float>(at[a]) + (a == edge.axis ? 0.5f : 0.0f);
    }
    return vertex;
  }

  /// Vertex indices on the edges along one axis.
  struct LayerEdges {
    std::vector<std::uint32_t> vertices;
    bool used = false;
  };

  const StructureCrop& crop_;
  /// [axis][0: lower, 1: upper slice of the layer]. Edges along k use only [2][0].
  std::array<std::array<LayerEdges, 2>, 3> edges_;
};

/// Stable sort of cells by leading voxel: counting sort by row, then a sort within rows.
std::vector<LedCell> by_leading_voxel(const std::vector<LedCell>& cells, const StructureCrop& crop) {
  const std::int64_t width = crop.size[0];
  std::vector<std::size_t> next(static_cast<std::size_t>(crop.size[1] * crop.size[2]) + 1, 0);
  for (const LedCell& cell : cells) ++next[static_cast<std::size_t>(cell.leading / width) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<LedCell> sorted(cells.size());
  for (const LedCell& cell : cells) sorted[next[static_cast<std::size_t>(cell.leading / width)]++] = cell;
  std::size_t begin = 0;
  for (const std::size_t end : next) {  // now the end of each row
    std::stable_sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
                     sorted.begin() + static_cast<std::ptrdiff_t>(end),
                     [](const LedCell& a, const LedCell& b) { return a.leading < b.leading; });
    begin = end;
  }
  return sorted;
}

/// Reorders triangles by cell and renumbers vertices by first use.
SurfaceMesh in_order(const SurfaceMesh& surface, const std::vector<LedCell>& cells) {
  SurfaceMesh ordered;
  ordered.triangles.reserve(surface.triangles.size());
  ordered.positions_ijk.reserve(surface.positions_ijk.size());
  std::vector<std::uint32_t> new_number(surface.positions_ijk.size(), kNone);
  for (const LedCell& cell : cells) {
    for (std::uint32_t t = 0; t < cell.triangles; ++t) {
      std::array<std::uint32_t, 3> triangle = surface.triangles[cell.first_triangle + t];
      for (std::uint32_t& vertex : triangle) {
        if (new_number[vertex] == kNone) {
          new_number[vertex] = static_cast<std::uint32_t>(ordered.positions_ijk.size());
          ordered.positions_ijk.push_back(surface.positions_ijk[vertex]);
        }
        vertex = new_number[vertex];
      }
      ordered.triangles.push_back(triangle);
    }
  }
  return ordered;
}

}  // namespace

std::span<const std::array<CellEdge, 3>> cell_triangles(std::uint8_t inside) {
  return std::span(kCases[inside].triangles).first(kCases[inside].count);
}

SurfaceMesh marching_cubes(const StructureCrop& crop) {
  CellWalker walker(crop);
  walker.walk();
  return in_order(walker.surface, by_leading_voxel(walker.cells, crop));
}

}  // namespace splatlas
