// Crossed voxel edges of a structure, linked across voxel faces, with the triangles of marching cubes
// (Lorensen and Cline 1987), and their normal-guided relaxation ("smoothing 1" and "2").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "format/content/surface.h"
#include "format/derive/structure_crop.h"

namespace splatlas {

/// An edge of a cell from `corner` along `axis`. Bit a of `corner` is its coordinate (0 or 1) along axis a.
struct CellEdge {
  std::uint8_t corner = 0, axis = 0;
  friend bool operator==(const CellEdge&, const CellEdge&) = default;
};

/// Edges of a cell are numbered by axis, then by corner.
inline constexpr std::size_t kCellEdges = 12;
[[nodiscard]] constexpr std::size_t number_of(const CellEdge& edge) {
  const auto above = static_cast<std::size_t>(edge.corner >> (edge.axis + 1));
  const auto below = edge.corner & ((1u << edge.axis) - 1);
  return edge.axis * std::size_t{4} + (above << edge.axis) + below;
}
[[nodiscard]] constexpr CellEdge cell_edge(std::size_t number) {
  const std::size_t axis = number / 4, corner = number % 4;
  const std::size_t above = corner >> axis << (axis + 1), below = corner & ((std::size_t{1} << axis) - 1);
  return {static_cast<std::uint8_t>(above | below), static_cast<std::uint8_t>(axis)};
}

/// Position of a neighbouring crossing relative to that of an edge along a from p to p + e_a, in the face on
/// side d of axis l:
///   - kParallel: on the edge from p + d e_l along a;
///   - kLow, kHigh: on the edge between p, or p + e_a, and its neighbour on that side;
///   - kCentre: ambiguous face, no neighbour.
enum class LinkKind : std::uint8_t { kParallel, kLow, kHigh, kCentre };

/// Crossed edges, triangles and links of a cell.
struct CellCase {
  static constexpr std::size_t kMaxTriangles = 5, kMaxLinks = 6;
  static constexpr std::uint8_t kNoEdge = kCellEdges;
  /// Neighbours of crossed edges in a face. Slots 0 to 3 of an edge along a look towards +b, -b, +c and -c,
  /// with b and c the axes after a, cyclically.
  struct Link {
    std::uint8_t from = kNoEdge, to = kNoEdge;  ///< indices into `edges`; kNoEdge behind the last link
    std::uint8_t slot = 0;
    LinkKind kind = LinkKind::kCentre;
  };

  std::uint8_t edge_count = 0, triangle_count = 0, link_count = 0;
  /// Numbers, by first use in `triangles`.
  std::array<std::uint8_t, kCellEdges> edges{};
  /// Indices into `edges`; counter-clockwise seen from outside in right-handed index axes.
  std::array<std::array<std::uint8_t, 3>, kMaxTriangles> triangles{};
  /// Links in the three faces with corner 0. Every face of the grid is such a face of one cell.
  std::array<Link, kMaxLinks> links{};
};

/// Cases of cells by inside corners (bit c: corner c): the oriented triangles of
/// vtkMarchingCubesTriangleCases. On each face, one line separates every maximal chain of inside corners, so
/// that diagonal inside corners stay separate and neighbouring cells agree.
using CellCases = std::array<CellCase, 256>;
[[nodiscard]] const CellCases& cell_cases();

/// Edge between a voxel and its successor along `axis`, one inside and one outside.
struct NetVertex {
  std::array<std::int32_t, 3> voxel{};  ///< grid index of the first one, from -1 on
  std::int32_t kind = 0;                ///< its axis, and kFirstIsInside

  static constexpr std::int32_t kFirstIsInside = 4;
  [[nodiscard]] std::size_t axis() const { return static_cast<std::size_t>(kind & 3); }
  [[nodiscard]] bool first_is_inside() const { return (kind & kFirstIsInside) != 0; }
  friend bool operator==(const NetVertex&, const NetVertex&) = default;
};

/// The surface of marching cubes (Lorensen and Cline 1987) without positions. Triangles are
/// counter-clockwise from outside in index space, sorted by the first boundary voxel of their cell (see
/// SurfaceMesh), then by cell in memory order, then as in CellCase. Vertices are numbered by first use.
struct SurfaceNet {
  std::vector<NetVertex> vertices;
  /// [vertex][slot of CellCase::Link]: the neighbour; the vertex itself in ambiguous faces.
  std::vector<std::array<std::uint32_t, 4>> neighbours;
  std::vector<std::uint8_t> kinds;  ///< [vertex]: LinkKind of its slots, two bits each, slot 0 lowest
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Threads keep the memory of nets up to this size for their next one: about 100 bytes per vertex. New pages
/// cost as much time as the work in them.
inline constexpr std::size_t kMaxKeptVertices = std::size_t{1} << 18;

/// Numbers vertices and triangles cell by cell, and appends them to a net. Its arrays have room for any cell,
/// so that single elements need no check. The element behind the last vertex takes padding.
class NetBuilder {
 public:
  /// Ids have 32 bits.
  static constexpr std::size_t kMaxVertices = std::numeric_limits<std::uint32_t>::max() - 1;

  /// Ids of vertices are their numbers plus 1; smaller ids than `next_id()` at any time mean earlier
  /// vertices. `vertices`: their expected number; more than kMaxVertices throw std::bad_alloc. The net is
  /// built in the memory of `reused`.
  explicit NetBuilder(std::size_t vertices, SurfaceNet reused = {});

  /// Adds a cell with corner 0 at grid index `cell`. `id_at(edge)` returns a reference to the id of an edge,
  /// `live_from(edge)` the smallest valid id there: smaller ones belong to other edges.
  template <typename IdAt, typename LiveFrom>
  void add_cell(const std::array<std::int32_t, 3>& cell, unsigned inside, const IdAt& id_at,
                const LiveFrom& live_from) {
    const CellCase& of = cases_[inside];
    make_room();
    // Local copies: the compiler cannot know that the stores below leave the members alone.
    Place place{net_.vertices.data(), net_.neighbours.data(), net_.kinds.data(),
                static_cast<std::uint32_t>(vertices_)};
    // Counts vary from cell to cell: padded links and triangles cost less than mispredicted ends of loops.
    std::array<std::uint32_t, kCellEdges + 1> numbers;  // [edge of the case]: its vertex
    const auto number_edges = [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const CellEdge edge = kEdges[of.edges[n]];
        numbers[n] = number_edge(cell, inside, of.edges[n], id_at(edge), live_from(edge), place);
      }
    };
    number_edges(0, 3);
    number_edges(3, of.edge_count);
    numbers[CellCase::kNoEdge] = place.count;
    for (const CellCase::Link& link : of.links) {
      const std::uint32_t from = numbers[link.from];
      place.neighbours[from][link.slot] = numbers[link.to];
      const unsigned change = (unsigned{kCentres} ^ static_cast<unsigned>(link.kind)) & 3u;
      place.kinds[from] = static_cast<std::uint8_t>(place.kinds[from] ^ change << 2 * link.slot);
    }
    std::array<std::uint32_t, 3>* const triangles = &net_.triangles[triangles_];
    const auto add_triangle = [&](std::size_t n) {
      const auto& [a, b, c] = of.triangles[n];
      triangles[n] = {numbers[a], numbers[b], numbers[c]};
    };
    for (std::size_t n = 0; n + 1 < CellCase::kMaxTriangles; ++n) add_triangle(n);
    if (of.triangle_count == CellCase::kMaxTriangles) add_triangle(CellCase::kMaxTriangles - 1);
    triangles_ += of.triangle_count;
    vertices_ = place.count;
  }

  /// The same for a cell that precedes all those without this mark.
  template <typename IdAt, typename LiveFrom>
  void add_early_cell(const std::array<std::int32_t, 3>& cell, unsigned inside, const IdAt& id_at,
                      const LiveFrom& live_from) {
    const std::size_t begin = triangles_;
    add_cell(cell, inside, id_at, live_from);
    early_.emplace_back(begin, triangles_);
  }

  [[nodiscard]] std::size_t triangles() const { return triangles_; }
  [[nodiscard]] std::uint32_t next_id() const { return static_cast<std::uint32_t>(vertices_ + 1); }
  /// The net, with vertices numbered by first use.
  [[nodiscard]] SurfaceNet finish();

 private:
  static constexpr std::uint8_t kCentres = 0xff;  ///< LinkKind::kCentre in all slots
  static constexpr std::array<CellEdge, kCellEdges> kEdges = [] {
    std::array<CellEdge, kCellEdges> edges{};
    for (std::size_t n = 0; n < edges.size(); ++n) edges[n] = cell_edge(n);
    return edges;
  }();

  /// Vertices of the edges of the cell at (0, 0, 0).
  static constexpr std::array<NetVertex, kCellEdges> kSteps = [] {
    std::array<NetVertex, kCellEdges> steps{};
    for (std::size_t n = 0; n < steps.size(); ++n) {
      const auto [corner, axis] = cell_edge(n);
      steps[n] = {{corner & 1, corner >> 1 & 1, corner >> 2}, axis};
    }
    return steps;
  }();

  void make_room() {
    if (vertices_ + kCellEdges >= net_.vertices.size() ||
        triangles_ + CellCase::kMaxTriangles > net_.triangles.size())
      grow();
  }
  void grow();
  void put_early_cells_first();

  /// The vertices so far.
  struct Place {
    NetVertex* vertices = nullptr;
    std::array<std::uint32_t, 4>* neighbours = nullptr;
    std::uint8_t* kinds = nullptr;
    std::uint32_t count = 0;
  };

  /// The vertex of an edge, without branches: the place behind the last one is overwritten until it is used.
  static std::uint32_t number_edge(const std::array<std::int32_t, 3>& cell, unsigned inside,
                                   std::size_t number, std::uint32_t& id, std::uint32_t live_from,
                                   Place& place) {
    const std::uint32_t next = place.count, old = id;
    const bool is_new = old < live_from;
    const NetVertex& step = kSteps[number];
    const auto side =
        static_cast<std::int32_t>((inside >> kEdges[number].corner & 1u) * NetVertex::kFirstIsInside);
    place.vertices[next] = {{cell[0] + step.voxel[0], cell[1] + step.voxel[1], cell[2] + step.voxel[2]},
                            step.kind + side};
    place.neighbours[next] = {next, next, next, next};
    place.kinds[next] = kCentres;
    const std::uint32_t now = is_new ? next + 1 : old;
    id = now;
    place.count = next + (is_new ? 1 : 0);
    return now - 1;
  }

  const CellCases& cases_;
  SurfaceNet net_;  // arrays with unused elements at their ends
  std::size_t vertices_ = 0, triangles_ = 0;
  std::vector<std::pair<std::size_t, std::size_t>> early_;  // ranges of triangles
};

/// The net of a crop of a whole structure, in the memory of `reused`. Cost: linear in the voxels of the crop,
/// an eighth of a byte each, and about 20 ns per triangle.
[[nodiscard]] SurfaceNet surface_net(const StructureCrop& crop, SurfaceNet reused = {});

/// Positions and directions of the vertices of a net.
struct SmoothedNet {
  static constexpr std::int32_t kScale = 256;
  std::vector<std::uint8_t> offsets;  ///< from the first voxel along the edge, in 1 / kScale voxel; 16 to 240
  /// Outwards in index axes, of any length but 0. The fourth element is 0.
  std::vector<std::array<std::int32_t, 4>> directions;
};

/// Smooths a net by 16 steps of averaging of area vectors and 8 steps of relaxation, docs/atlas_surfaces.md.
/// Integers only: the same bits on every machine, whatever the numbering of the vertices. Mirrored and
/// complementary masks have mirrored and opposite results. The result is in the memory of `reused`, the
/// offsets only with `with_offsets`. Cost: about 60 ns and 80 bytes per vertex.
[[nodiscard]] SmoothedNet smooth(const SurfaceNet& net, SmoothedNet reused = {}, bool with_offsets = true);

/// Positions of SurfaceRule::kUneven, docs/atlas_surfaces.md: middles of edges moved onto the planes between
/// them and their neighbours, by the directions of smooth() (Sun et al. 2007, "Fast and effective
/// feature-preserving mesh denoising", vertex updating), and along the surface, so that overhanging steps
/// unfold. So labels that jump from slice to slice are joined, and planes and tubes keep their thickness. A
/// vertex moves at most half the longest side of a voxel. Thin parts may cross within that distance. The same
/// bits on every machine. Complementary masks have equal results. Cost: about 0.2 us, 170 bytes per vertex.
[[nodiscard]] std::vector<std::array<float, 3>> smooth_across(const SurfaceNet& net,
                                                              const SmoothedNet& smoothed, const Grid& grid);

}  // namespace splatlas
