#include "tests/support/marching_tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "format/content/unit_vector.h"

namespace splatlas {
namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

/// Corners of a tetrahedron: the bits are x, y and z of a corner of the cell.
using Tetrahedron = std::array<unsigned, 4>;

/// Tetrahedra of the six axis-parallel paths from corner 0 to corner 7.
std::vector<Tetrahedron> cell_tetrahedra() {
  std::vector<Tetrahedron> all;
  std::array<unsigned, 3> axes{0, 1, 2};
  do {
    const unsigned first = 1u << axes[0];
    all.push_back({0, first, first | 1u << axes[1], 7});
  } while (std::next_permutation(axes.begin(), axes.end()));
  return all;
}

class Mesher {
 public:
  Mesher(const std::vector<bool>& mask, const Grid& grid)
      : mask_(mask), grid_(grid), to_lps_(index_to_lps_mm(grid)) {
    std::size_t places = 1;
    for (std::size_t a = 0; a < 3; ++a) places *= static_cast<std::size_t>(2 * grid.size[a] + 1);
    vertices_.assign(places, kNoVertex);
  }

  SurfaceMesh make() {
    static const std::vector<Tetrahedron> kTetrahedra = cell_tetrahedra();
    for (std::int64_t k = -1; k < grid_.size[2]; ++k) {
      for (std::int64_t j = -1; j < grid_.size[1]; ++j) {
        for (std::int64_t i = -1; i < grid_.size[0]; ++i) {
          for (const Tetrahedron& tetrahedron : kTetrahedra) cut({i, j, k}, tetrahedron);
        }
      }
    }
    for (std::size_t n = 0; n < normals_.size(); ++n) {
      const Vec3& sum = normals_[n];
      mesh_.normals_lps.push_back(unpack_normal(
          pack_normal({static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])})));
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] bool holds(const Index3& at) const {
    return grid_.contains(at[0], at[1], at[2]) &&
           mask_[static_cast<std::size_t>(grid_.offset(at[0], at[1], at[2]))];
  }

  void cut(const Index3& cell, const Tetrahedron& tetrahedron) {
    std::vector<Index3> in;
    std::vector<Index3> out;
    for (const unsigned corner : tetrahedron) {
      const Index3 at{cell[0] + (corner & 1u), cell[1] + (corner >> 1u & 1u), cell[2] + (corner >> 2u)};
      (holds(at) ? in : out).push_back(at);
    }
    if (in.empty() || out.empty()) return;
    const Vec3 outward = difference(middle(out), middle(in));
    if (in.size() == 2) {
      add({vertex_between(in[0], out[0]), vertex_between(in[0], out[1]), vertex_between(in[1], out[1])},
          outward);
      add({vertex_between(in[0], out[0]), vertex_between(in[1], out[1]), vertex_between(in[1], out[0])},
          outward);
      return;
    }
    const Index3 apex = in.size() == 1 ? in[0] : out[0];
    const std::vector<Index3>& base = in.size() == 1 ? out : in;
    add({vertex_between(apex, base[0]), vertex_between(apex, base[1]), vertex_between(apex, base[2])},
        outward);
  }

  [[nodiscard]] Vec3 middle(const std::vector<Index3>& corners) const {
    Vec3 sum{0, 0, 0};
    for (const Index3& corner : corners) {
      for (std::size_t a = 0; a < 3; ++a) {
        sum[a] += static_cast<double>(corner[a]) / static_cast<double>(corners.size());
      }
    }
    return to_lps_.apply(sum);
  }

  std::uint32_t vertex_between(const Index3& a, const Index3& b) {
    const Index3 doubled{a[0] + b[0], a[1] + b[1], a[2] + b[2]};  // from -1 to 2 * size - 1
    const Index3& n = grid_.size;
    const std::int64_t place =
        ((doubled[2] + 1) * (2 * n[1] + 1) + doubled[1] + 1) * (2 * n[0] + 1) + doubled[0] + 1;
    std::uint32_t& vertex = vertices_[static_cast<std::size_t>(place)];
    if (vertex == kNoVertex) {
      vertex = static_cast<std::uint32_t>(mesh_.positions_ijk.size());
      std::array<float, 3> position{};
      for (std::size_t axis = 0; axis < 3; ++axis) position[axis] = static_cast<float>(doubled[axis]) / 2;
      mesh_.positions_ijk.push_back(position);
      normals_.push_back({0, 0, 0});
    }
    return vertex;
  }

  void add(std::array<std::uint32_t, 3> triangle, const Vec3& outward) {
    std::array<Vec3, 3> corner{};
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& p = mesh_.positions_ijk[triangle[n]];
      corner[n] = to_lps_.apply({p[0], p[1], p[2]});
    }
    Vec3 normal = cross(difference(corner[1], corner[0]), difference(corner[2], corner[0]));
    if (dot(normal, outward) < 0) {
      std::swap(triangle[1], triangle[2]);
      for (double& n : normal) n = -n;
    }
    mesh_.triangles.push_back(triangle);
    const double length = std::sqrt(dot(normal, normal));
    for (const std::uint32_t v : triangle) {
      for (std::size_t a = 0; a < 3; ++a) normals_[v][a] += normal[a] / length;
    }
  }

  const std::vector<bool>& mask_;
  const Grid& grid_;
  const Affine to_lps_;
  SurfaceMesh mesh_;
  std::vector<std::uint32_t> vertices_;  // by doubled position
  std::vector<Vec3> normals_;            // sums over triangles, LPS
};

}  // namespace

SurfaceMesh marching_tetrahedra(const std::vector<bool>& mask, const Grid& grid) {
  return Mesher(mask, grid).make();
}

}  // namespace splatlas
