// Case tables of marching cubes on binary masks (Lorensen and Cline 1987).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

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

}  // namespace splatlas
