#include "format/derive/fit_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

using Vec3f = std::array<float, 3>;

Vec3f opposite(const Vec3f& v) {
  return {-v[0], -v[1], -v[2]};
}

/// The voxels at both ends of a vertex's edge.
std::array<Index3, 2> ends_of(const NetVertex& vertex) {
  std::array<Index3, 2> ends{Index3{vertex.voxel[0], vertex.voxel[1], vertex.voxel[2]}, {}};
  ends[1] = ends[0];
  ++ends[1][vertex.axis()];
  return ends;
}

/// One of the two voxels at the ends of a vertex's cell edge.
struct VertexEnd {
  std::uint32_t vertex;
  std::uint32_t in_slice;  ///< offset within the slice
};
/// The end voxels of all vertices, sorted by slice of the crop.
struct VertexEnds {
  std::vector<VertexEnd> ends;
  std::vector<std::size_t> first_of_slice;  ///< size + 1 offsets
};

VertexEnds ends_by_slice(std::span<const NetVertex> vertices, const StructureCrop& crop) {
  VertexEnds result;
  result.first_of_slice.assign(static_cast<std::size_t>(crop.size[2]) + 1, 0);
  const auto visit_ends = [&](auto&& visit) {
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      for (const Index3& at : ends_of(vertices[v])) {
        const std::int64_t row = at[1] - crop.first[1], in_row = at[0] - crop.first[0];
        visit(static_cast<std::size_t>(at[2] - crop.first[2]),
              VertexEnd{v, static_cast<std::uint32_t>(row * crop.size[0] + in_row)});
      }
    }
  };
  visit_ends([&](std::size_t slice, const VertexEnd&) { ++result.first_of_slice[slice + 1]; });
  std::partial_sum(result.first_of_slice.begin(), result.first_of_slice.end(), result.first_of_slice.begin());
  result.ends.resize(result.first_of_slice.back());
  std::vector<std::size_t> next = result.first_of_slice;
  visit_ends([&](std::size_t slice, const VertexEnd& end) { result.ends[next[slice]++] = end; });
  return result;
}

/// Area-weighted normals of the triangles around each vertex, in LPS.
std::vector<Vec3f> face_normals(const SurfaceMesh& mesh, const Affine& to_mm) {
  const auto to_lps = [&](const Vec3f& edge) {
    const Vec3 mm = to_mm.apply_linear({edge[0], edge[1], edge[2]});
    return Vec3f{static_cast<float>(mm[0]), static_cast<float>(mm[1]), static_cast<float>(mm[2])};
  };
  std::vector<Vec3f> normals(mesh.positions_ijk.size(), Vec3f{0, 0, 0});
  for (const auto& t : mesh.triangles) {
    const Vec3f& corner = mesh.positions_ijk[t[0]];
    const Vec3f normal = cross(to_lps(difference(mesh.positions_ijk[t[1]], corner)),
                               to_lps(difference(mesh.positions_ijk[t[2]], corner)));
    for (const std::uint32_t vertex : t) {
      for (std::size_t a = 0; a < 3; ++a) normals[vertex][a] += normal[a];
    }
  }
  return normals;
}

Vec3f unit_or_up(const Vec3f& v) {
  const float length = std::sqrt(dot(v, v));
  if (!(length > 0)) return {0, 0, 1};
  return {v[0] / length, v[1] / length, v[2] / length};
}

/// Sums of the gradients at both ends of every vertex's cell edge.
std::vector<Vec3f> vertex_gradients(std::span<const NetVertex> vertices, const StructureCrop& crop,
                                    const SliceVisitor& visit_slice) {
  const VertexEnds ends = ends_by_slice(vertices, crop);
  std::vector<Vec3f> gradients(vertices.size(), Vec3f{0, 0, 0});
  SmoothGradient gradient(crop);
  for (std::int64_t k = 0; k < crop.size[2]; ++k) {
    gradient.next_slice();
    for (std::size_t n = ends.first_of_slice[static_cast<std::size_t>(k)];
         n < ends.first_of_slice[static_cast<std::size_t>(k) + 1]; ++n) {
      const auto [vertex, at] = ends.ends[n];
      const Vec3f g = gradient.at(at % crop.size[0], at / crop.size[0]);
      for (std::size_t a = 0; a < 3; ++a) gradients[vertex][a] += g[a];
    }
    if (visit_slice) visit_slice(gradient, k);
  }
  return gradients;
}

/// The same from runs.
std::vector<Vec3f> sparse_vertex_gradients(std::span<const NetVertex> vertices, const PartRows& rows) {
  struct End {
    Index3 at{0, 0, 0};
    std::uint32_t vertex = 0;
  };
  std::vector<End> ends;
  ends.reserve(2 * vertices.size());
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    for (const Index3& at : ends_of(vertices[v])) ends.push_back({at, v});
  }
  std::ranges::sort(ends, {}, [](const End& end) { return std::tuple(end.at[2], end.at[1], end.at[0]); });
  std::vector<Vec3f> gradients(vertices.size(), Vec3f{0, 0, 0});
  SparseGradient gradient(rows);
  Vec3f g{0, 0, 0};
  TaskPace pace;
  for (std::size_t n = 0; n < ends.size(); ++n) {
    pace.step();
    const auto [i, j, k] = ends[n].at;
    if (n == 0 || ends[n].at != ends[n - 1].at) g = gradient.at(i, j, k);
    for (std::size_t a = 0; a < 3; ++a) gradients[ends[n].vertex][a] += g[a];
  }
  return gradients;
}

void visit_slices(const StructureCrop& crop, const SliceVisitor& visit_slice) {
  SmoothGradient gradient(crop);
  for (std::int64_t k = 0; k < crop.size[2]; ++k) {
    gradient.next_slice();
    visit_slice(gradient, k);
  }
}

/// Position at `offset` from a vertex's first voxel.
Vec3f position_of(const NetVertex& vertex, float offset) {
  Vec3f position;
  for (std::size_t a = 0; a < 3; ++a) position[a] = static_cast<float>(vertex.voxel[a]);
  position[vertex.axis()] += offset;
  return position;
}

/// A mesh with vertices midway between voxels. Consumes the net.
SurfaceMesh midway_mesh(SurfaceNet net, const std::vector<Vec3f>& gradients, const Grid& grid,
                        SurfaceRule rule) {
  SurfaceMesh mesh = triangles_of(net, grid, rule);
  mesh.positions_ijk.reserve(net.vertices.size());
  for (const NetVertex& vertex : net.vertices) mesh.positions_ijk.push_back(position_of(vertex, 0.5f));
  mesh.normals_lps = face_normals(mesh, index_to_lps_mm(grid));
  const VoxelNormals voxel_normals(grid);
  for (std::size_t v = 0; v < gradients.size(); ++v) {
    Vec3f& normal = mesh.normals_lps[v];
    const Vec3f inwards = voxel_normals.to_lps(gradients[v]);
    if (dot(inwards, normal) < 0) normal = opposite(inwards);
    normal = unit_or_up(normal);
  }
  round_normals(mesh.normals_lps);
  return mesh;
}

/// Memory of a thread's last net.
struct Kept {
  SurfaceNet net;
  SmoothedNet smoothed;

  static Kept& of_thread() {
    static thread_local Kept kept;
    return kept;
  }
};

/// A smoothed mesh. Consumes the net and keeps its memory.
SurfaceMesh smooth_mesh(SurfaceNet net, const Grid& grid, SurfaceRule rule) {
  SmoothedNet smoothed = smooth(net, std::move(Kept::of_thread().smoothed), rule == SurfaceRule::kSmooth);
  SurfaceMesh mesh = triangles_of(net, grid, rule);
  if (rule == SurfaceRule::kUneven) mesh.positions_ijk = smooth_across(net, smoothed, grid);
  mesh.positions_ijk.resize(net.vertices.size());
  mesh.normals_lps.resize(net.vertices.size());
  const VoxelNormals voxel_normals(grid);
  for (std::size_t v = 0; v < net.vertices.size(); ++v) {
    constexpr float kUnit = 1.0f / SmoothedNet::kScale;
    if (rule == SurfaceRule::kSmooth)
      mesh.positions_ijk[v] = position_of(net.vertices[v], kUnit * static_cast<float>(smoothed.offsets[v]));
    Vec3f direction;
    for (std::size_t a = 0; a < 3; ++a) direction[a] = static_cast<float>(smoothed.directions[v][a]);
    mesh.normals_lps[v] = voxel_normals.to_lps(direction);
  }
  round_normals(mesh.normals_lps);
  if (net.vertices.size() <= kMaxKeptVertices) Kept::of_thread() = {std::move(net), std::move(smoothed)};
  return mesh;
}

/// The normals against gradients.
std::vector<PackedNormal> normals_against(std::vector<Vec3f> gradients, const Grid& grid) {
  const VoxelNormals of_grid(grid);
  for (Vec3f& gradient : gradients) gradient = opposite(of_grid.to_lps(gradient));
  return pack_normals(gradients);
}

IndexBox widened(IndexBox box, std::int64_t voxels) {
  for (std::size_t a = 0; a < 3; ++a) {
    box.first[a] -= voxels;
    box.last[a] += voxels;
  }
  return box;
}

}  // namespace

Vec3f VoxelNormals::to_lps(const Vec3f& g) const {
  Vec3f result;
  for (std::size_t c = 0; c < 3; ++c) {
    result[c] = static_cast<float>(to_index_[c] * g[0] + to_index_[3 + c] * g[1] + to_index_[6 + c] * g[2]);
  }
  return result;
}

SurfaceMesh triangles_of(SurfaceNet& net, const Grid& grid, SurfaceRule rule) {
  SurfaceMesh mesh;
  mesh.position_scale = static_cast<std::uint32_t>(rule);
  mesh.triangles = std::move(net.triangles);
  if (determinant(index_to_lps_mm(grid).linear) < 0) {  // mirrors
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

PackedNormal VoxelNormals::normal(const Vec3f& gradient) const {
  return pack_normal(opposite(to_lps(gradient)));
}

SurfaceMesh fit_surface(const StructureCrop& crop, const Grid& grid, SurfaceRule rule,
                        const SliceVisitor& visit_slice) {
  SurfaceNet net = surface_net(crop, std::move(Kept::of_thread().net));
  if (rule != SurfaceRule::kVoxels) {
    if (visit_slice) visit_slices(crop, visit_slice);
    return smooth_mesh(std::move(net), grid, rule);
  }
  const std::vector<Vec3f> gradients = vertex_gradients(net.vertices, crop, visit_slice);
  return midway_mesh(std::move(net), gradients, grid, rule);
}

std::optional<SurfaceMesh> fit_sparse_surface(const PartRows& rows, const Grid& grid, SurfaceRule rule,
                                              std::uint64_t max_triangles) {
  std::optional<SurfaceNet> net = sparse_surface_net(rows, max_triangles);
  if (!net) return std::nullopt;
  if (rule != SurfaceRule::kVoxels) return smooth_mesh(*std::move(net), grid, rule);
  const std::vector<Vec3f> gradients = sparse_vertex_gradients(net->vertices, rows);
  return midway_mesh(*std::move(net), gradients, grid, rule);
}

IndexBox around(const IndexBox& box) {
  return widened(box, SmoothGradient::kRadius);
}

StructureCrop crop_around(const IndexBox& box) {
  return empty_crop(widened(box, SmoothGradient::kRadius - 1));  // empty_crop() adds one voxel on every side
}

std::vector<PackedNormal> fit_normals(const StructureCrop& crop, std::span<const Run> runs,
                                      const Grid& grid) {
  std::vector<Vec3f> gradients;
  SmoothGradient gradient(crop);
  RunsBySlice slices{kEmptyClass, runs};
  for (std::int64_t k = 0; k < crop.size[2] && !slices.left.empty(); ++k) {
    gradient.next_slice();
    slices.visit_slice(k, crop, grid.size[1],
                       [&](std::int64_t i, std::int64_t j) { gradients.push_back(gradient.at(i, j)); });
  }
  return normals_against(std::move(gradients), grid);
}

std::vector<PackedNormal> fit_sparse_normals(const PartRows& rows, std::span<const Run> runs,
                                             const Grid& grid) {
  std::vector<Vec3f> gradients;
  SparseGradient gradient(rows);
  for (const Run& run : runs) {
    check_task();
    const auto scanline = static_cast<std::int64_t>(run.scanline);
    const std::int64_t j = scanline % grid.size[1], k = scanline / grid.size[1];
    for (std::uint32_t n = 0; n < run.length; ++n)
      gradients.push_back(gradient.at(std::int64_t{run.start} + n, j, k));
  }
  return normals_against(std::move(gradients), grid);
}

StructureIndex normal_owner(std::span<const Membership> members) {
  for (const Membership& m : members) {
    if (m.part == Part::kBoundary) return m.structure;
  }
  return kNoStructure;
}

std::vector<StructureIndex> normal_owners(const ClassTable& classes) {
  std::vector<StructureIndex> owners(classes.size());
  for (ClassId c = 0; c < classes.size(); ++c) owners[c] = normal_owner(classes.members(c));
  return owners;
}

}  // namespace splatlas
