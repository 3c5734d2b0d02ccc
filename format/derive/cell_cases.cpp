#include <string_view>
#include <utility>

#include "format/derive/surface_net.h"

namespace splatlas {
namespace {

constexpr CellEdge edge_between(unsigned a, unsigned b) {
  const unsigned bit = a ^ b;
  return {static_cast<std::uint8_t>(a & b), static_cast<std::uint8_t>(bit == 1 ? 0 : bit == 2 ? 1 : 2)};
}

/// Corners of a face, counter-clockwise seen from outside the cell.
constexpr std::array<unsigned, 4> face_corners(unsigned axis, bool far_side) {
  const unsigned b = 1u << (axis + 1) % 3, c = 1u << (axis + 2) % 3, at = far_side ? 1u << axis : 0;
  return far_side ? std::array<unsigned, 4>{at, at | b, at | b | c, at | c}
                  : std::array<unsigned, 4>{at, at | c, at | b | c, at | b};
}

/// Numbers of crossed edges around one or more inside corners.
struct Loop {
  std::array<std::uint8_t, kCellEdges> edges{};
  std::size_t count = 0;

  [[nodiscard]] constexpr std::uint8_t at(std::size_t n) const { return edges[n % count]; }
};
struct Loops {
  std::array<Loop, 4> loops{};
  std::size_t count = 0;
};

/// Loops of a cell by lowest edge. Each begins with its lowest edge.
constexpr Loops loops_of(unsigned inside) {
  const auto is_inside = [&](unsigned corner) { return (inside >> corner & 1) != 0; };
  std::array<std::size_t, kCellEdges> next{};  // successor of each edge in its loop, or kCellEdges
  next.fill(kCellEdges);
  for (unsigned face = 0; face < 6; ++face) {
    const std::array<unsigned, 4> corners = face_corners(face / 2, face % 2 == 1);
    for (unsigned n = 0; n < 4; ++n) {
      if (is_inside(corners[n]) || !is_inside(corners[(n + 1) % 4])) continue;
      // Find the end of the chain of inside corners that begins here.
      unsigned last = n + 1;
      while (is_inside(corners[(last + 1) % 4])) ++last;
      next[number_of(edge_between(corners[n], corners[(n + 1) % 4]))] =
          number_of(edge_between(corners[last % 4], corners[(last + 1) % 4]));
    }
  }
  Loops found;
  for (std::size_t first = 0; first < kCellEdges; ++first) {
    if (next[first] == kCellEdges) continue;
    Loop& loop = found.loops[found.count++];
    for (std::size_t edge = first; next[edge] != kCellEdges; edge = std::exchange(next[edge], kCellEdges))
      loop.edges[loop.count++] = static_cast<std::uint8_t>(edge);
  }
  return found;
}

/// Collects triangles of edge numbers, and numbers the edges by first use.
class CaseBuilder {
 public:
  constexpr void add(std::uint8_t a, std::uint8_t b, std::uint8_t c) {
    result.triangles[result.triangle_count++] = {index_of(a), index_of(b), index_of(c)};
  }
  constexpr void add_fan(const Loop& loop, std::size_t start) {
    for (std::size_t n = 1; n + 1 < loop.count; ++n)
      add(loop.at(start), loop.at(start + n), loop.at(start + n + 1));
  }
  constexpr void add_link(std::size_t from, std::size_t to, std::size_t slot, LinkKind kind) {
    result.links[result.link_count++] = {index_of(static_cast<std::uint8_t>(from)),
                                         index_of(static_cast<std::uint8_t>(to)),
                                         static_cast<std::uint8_t>(slot), kind};
  }

  CellCase result;

 private:
  constexpr std::uint8_t index_of(std::uint8_t edge) {
    std::uint8_t n = 0;
    while (n < result.edge_count && result.edges[n] != edge) ++n;
    if (n == result.edge_count) result.edges[result.edge_count++] = edge;
    return n;
  }
};

/// [inside]: triangulation of the loops of more than three edges, see add_as_vtk(). A cell has one such loop,
/// or two of four edges.
constexpr std::string_view kVtkDigits =
    "0001000100120210"
    "0102040c01160733"
    "00010006004c0464"
    "0120074403732001"
    "0001000700141a64"
    "1317012210117060"
    "00030223001c3c32"
    "296362114b410000"
    "00010003113626b3"
    "0104010c110444b1"
    "0007012630107121"
    "16d433d576000000"
    "1111274013700340"
    "163081d062204020"
    "247065508d133110"
    "0430311045001000";

constexpr unsigned vtk_digit(unsigned inside) {
  const char digit = kVtkDigits[inside];
  return static_cast<unsigned>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
}

/// Six edges in four triangles that are no fan. Digits 6 and 7: three corners are cut off, a triangle is
/// left. 8 to 10: two corners are cut off, then the diagonal from the second to the fifth edge of the rest.
/// 11 to 13: the mirrored diagonal.
constexpr void add_hexagon(const Loop& loop, unsigned digit, CaseBuilder& builder) {
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    builder.add(loop.at(a), loop.at(b), loop.at(c));
  };
  if (digit < 8) {
    const std::size_t s = digit - 6;
    for (std::size_t n = s; n < s + 6; n += 2) add(n, n + 1, n + 2);
    return add(s, s + 2, s + 4);
  }
  const std::size_t s = (digit - 8) % 3;
  const bool mirrored = digit > 10;
  add(s, s + 1, s + 2);
  add(s, s + 2, mirrored ? s + 3 : s + 5);
  add(mirrored ? s : s + 2, s + 3, s + 5);
  add(s + 3, s + 4, s + 5);
}

constexpr void add_as_vtk(const Loops& loops, unsigned digit, CaseBuilder& builder) {
  for (std::size_t n = 0, of_four = 0; n < loops.count; ++n) {
    const Loop& loop = loops.loops[n];
    if (loop.count == 3) {
      builder.add_fan(loop, 0);
    } else if (loop.count == 4) {
      builder.add_fan(loop, digit >> of_four++ & 1);
    } else if (digit < loop.count) {
      builder.add_fan(loop, digit);
    } else {
      add_hexagon(loop, digit, builder);
    }
  }
}

/// Links in the faces with corner 0.
constexpr void add_links(unsigned inside, CaseBuilder& builder) {
  const auto is_inside = [&](unsigned corner) { return (inside >> corner & 1) != 0; };
  for (unsigned a = 0; a < 3; ++a) {
    for (unsigned l = 0; l < 3; ++l) {
      if (l == a) continue;
      for (unsigned side = 0; side < 2; ++side) {  // 1: the edge has a neighbour towards -l
        const unsigned p = side << l, above = p | 1u << a, beside = p ^ 1u << l;
        const bool in_p = is_inside(p), in_above = is_inside(above);
        const bool in_beside = is_inside(beside), in_both = is_inside(beside | 1u << a);
        if (in_p == in_above) continue;
        const std::size_t from = number_of(edge_between(p, above));
        const std::size_t slot = (l == (a + 1) % 3 ? 0u : 2u) + side;
        if (in_beside == in_p && in_both == in_above) {
          builder.add_link(from, number_of(edge_between(beside, beside | 1u << a)), slot,
                           LinkKind::kParallel);
        } else if (in_beside == in_above && in_both == in_above) {
          builder.add_link(from, number_of(edge_between(p, beside)), slot, LinkKind::kLow);
        } else if (in_beside == in_p && in_both == in_p) {
          builder.add_link(from, number_of(edge_between(above, beside | 1u << a)), slot, LinkKind::kHigh);
        }
      }
    }
  }
}

constexpr CellCases make_cases() {
  CellCases cases{};
  for (unsigned inside = 0; inside < cases.size(); ++inside) {
    const Loops loops = loops_of(inside);
    CaseBuilder builder;
    add_as_vtk(loops, vtk_digit(inside), builder);
    add_links(inside, builder);
    cases[inside] = builder.result;
  }
  return cases;
}

constinit const CellCases kCases = make_cases();

}  // namespace

const CellCases& cell_cases() {
  return kCases;
}

}  // namespace splatlas
