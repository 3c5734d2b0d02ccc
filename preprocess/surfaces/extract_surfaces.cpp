#include "preprocess/surfaces/extract_surfaces.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "format/parallel.h"
#include "preprocess/surfaces/marching_cubes.h"
#include "preprocess/surfaces/smooth_gradient.h"
#include "preprocess/surfaces/structure_crop.h"

namespace splatlas {
namespace {

using Vec3f = std::array<float, 3>;

Vec3f cross(const Vec3f& a, const Vec3f& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
float dot(const Vec3f& a, const Vec3f& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3f difference(const Vec3f& a, const Vec3f& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// How vectors of index space look in LPS mm.
class IndexFrame {
 public:
  explicit IndexFrame(const Grid& grid)
      : to_mm_(index_to_lps_mm(grid).linear), to_index_(lps_mm_to_index(grid).linear) {}

  /// Positions and edges.
  [[nodiscard]] Vec3f edge_to_lps(const Vec3f& e) const {
    Vec3f result;
    for (std::size_t r = 0; r < 3; ++r) {
      result[r] =
          static_cast<float>(to_mm_[3 * r] * e[0] + to_mm_[3 * r + 1] * e[1] + to_mm_[3 * r + 2] * e[2]);
    }
    return result;
  }
  /// Gradients: by the inverse's transpose.
  [[nodiscard]] Vec3f gradient_to_lps(const Vec3f& g) const {
    Vec3f result;
    for (std::size_t c = 0; c < 3; ++c) {
      result[c] = static_cast<float>(to_index_[c] * g[0] + to_index_[3 + c] * g[1] + to_index_[6 + c] * g[2]);
    }
    return result;
  }
  /// Whether triangles that are counter-clockwise in index space are clockwise in LPS.
  [[nodiscard]] bool mirrors() const {
    const Matrix3& m = to_mm_;
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
               m[2] * (m[3] * m[7] - m[4] * m[6]) <
           0;
  }

 private:
  Matrix3 to_mm_, to_index_;
};

/// Finds the voxel that leads to a triangle: of its cell's corners, the boundary voxel of smallest offset.
class LeadingVoxels {
 public:
  LeadingVoxels(const Classification& classification, const Index3& size, std::span<const std::uint8_t> parts)
      : volume_(classification.volume), size_(size), parts_(parts) {}

  [[nodiscard]] std::int64_t of(const FittedSurface& surface,
                                const std::array<std::uint32_t, 3>& triangle) const {
    Index3 cell;
    for (std::size_t a = 0; a < 3; ++a) {
      const float sum = surface.positions_ijk[triangle[0]][a] + surface.positions_ijk[triangle[1]][a] +
                        surface.positions_ijk[triangle[2]][a];
      cell[a] = static_cast<std::int64_t>(std::floor(sum / 3));
    }
    for (int corner = 0; corner < 8; ++corner) {  // by rising offset
      const std::int64_t i = cell[0] + (corner & 1), j = cell[1] + (corner >> 1 & 1),
                         k = cell[2] + (corner >> 2);
      if (i < 0 || j < 0 || k < 0 || i >= size_[0] || j >= size_[1] || k >= size_[2]) continue;
      const std::int64_t offset = (k * size_[1] + j) * size_[0] + i;
      if (parts_[volume_[static_cast<std::size_t>(offset)]] == 2) return offset;
    }
    return 0;  // cannot be: a cell with a triangle has a voxel inside next to one outside
  }

 private:
  std::span<const ClassId> volume_;
  Index3 size_;
  std::span<const std::uint8_t> parts_;
};

/// Triangles by leading voxel, as marching cubes met them within one; vertices in the order of first use.
SurfaceMesh ordered_mesh(const FittedSurface& surface, const LeadingVoxels& leading, bool mirrored) {
  std::vector<std::pair<std::int64_t, std::uint32_t>> order(surface.triangles.size());
  for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = {leading.of(surface, surface.triangles[t]), t};
  std::sort(order.begin(), order.end());

  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> new_number(surface.positions_ijk.size(), kUnused);
  SurfaceMesh mesh;
  mesh.triangles.reserve(order.size());
  mesh.positions_ijk.reserve(surface.positions_ijk.size());
  for (const auto& [voxel, t] : order) {
    std::array<std::uint32_t, 3> triangle = surface.triangles[t];
    if (mirrored) std::swap(triangle[1], triangle[2]);
    for (std::uint32_t& vertex : triangle) {
      if (new_number[vertex] == kUnused) {
        new_number[vertex] = static_cast<std::uint32_t>(mesh.positions_ijk.size());
        mesh.positions_ijk.push_back(surface.positions_ijk[vertex]);
      }
      vertex = new_number[vertex];
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// Every vertex lies midway between two voxels: those voxels, sorted by slice of the crop.
struct VertexEnd {
  std::uint32_t vertex;
  std::uint32_t in_slice;  ///< offset within the slice
};
struct VertexEnds {
  std::vector<VertexEnd> ends;
  std::vector<std::size_t> first_of_slice;  ///< size + 1
};

VertexEnds ends_by_slice(const SurfaceMesh& mesh, const StructureCrop& crop) {
  VertexEnds result;
  result.first_of_slice.assign(static_cast<std::size_t>(crop.size[2]) + 1, 0);
  const auto visit_ends = [&](auto&& visit) {
    for (std::uint32_t v = 0; v < mesh.positions_ijk.size(); ++v) {
      for (const float towards :
           {-0.25f, 0.25f}) {  // rounds halves down, then up; leaves whole numbers alone
        Index3 at;
        for (std::size_t a = 0; a < 3; ++a) {
          at[a] = static_cast<std::int64_t>(std::floor(mesh.positions_ijk[v][a] + towards + 0.5f)) -
                  crop.first[a];
        }
        visit(static_cast<std::size_t>(at[2]),
              VertexEnd{v, static_cast<std::uint32_t>(at[1] * crop.size[0] + at[0])});
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
std::vector<Vec3f> face_normals(const SurfaceMesh& mesh, const IndexFrame& frame) {
  std::vector<Vec3f> normals(mesh.positions_ijk.size(), Vec3f{0, 0, 0});
  for (const auto& t : mesh.triangles) {
    const Vec3f& corner = mesh.positions_ijk[t[0]];
    const Vec3f normal = cross(frame.edge_to_lps(difference(mesh.positions_ijk[t[1]], corner)),
                               frame.edge_to_lps(difference(mesh.positions_ijk[t[2]], corner)));
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

/// Everything that is done for one structure.
class StructureExtractor {
 public:
  StructureExtractor(const Classification& classification, const Grid& grid,
                     std::span<const StructureIndex> normal_owner, std::span<PackedNormal> normals)
      : classification_(classification),
        grid_(grid),
        frame_(grid),
        normal_owner_(normal_owner),
        normals_(normals) {}

  /// The surface of a structure within `box`; writes the normals of the boundary voxels that it owns.
  [[nodiscard]] SurfaceMesh extract(StructureIndex structure, const IndexBox& box) const {
    const std::vector<std::uint8_t> parts = parts_of(classification_.classes, structure);
    const StructureCrop crop = crop_structure(classification_.volume, grid_.size, box, parts);
    const LeadingVoxels leading(classification_, grid_.size, parts);
    SurfaceMesh mesh = ordered_mesh(marching_cubes(crop), leading, frame_.mirrors());
    const VertexEnds ends = ends_by_slice(mesh, crop);
    std::vector<Vec3f> gradients(mesh.positions_ijk.size(), Vec3f{0, 0, 0});
    SmoothGradient gradient(crop);
    for (std::int64_t k = 0; k < crop.size[2]; ++k) {
      gradient.next_slice();
      for (std::size_t n = ends.first_of_slice[static_cast<std::size_t>(k)];
           n < ends.first_of_slice[static_cast<std::size_t>(k) + 1]; ++n) {
        const auto [vertex, at] = ends.ends[n];
        const Vec3f g = gradient.at(at % crop.size[0], at / crop.size[0]);
        for (std::size_t a = 0; a < 3; ++a) gradients[vertex][a] += g[a];
      }
      write_voxel_normals(structure, crop, gradient, k);
    }
    mesh.normals_lps = vertex_normals(mesh, gradients);
    return mesh;
  }

 private:
  /// Against the gradient, and outwards in any case.
  [[nodiscard]] std::vector<Vec3f> vertex_normals(const SurfaceMesh& mesh,
                                                  std::span<const Vec3f> gradients) const {
    std::vector<Vec3f> normals = face_normals(mesh, frame_);
    for (std::size_t v = 0; v < normals.size(); ++v) {
      const Vec3f inwards = frame_.gradient_to_lps(gradients[v]);
      if (dot(inwards, normals[v]) < 0) normals[v] = {-inwards[0], -inwards[1], -inwards[2]};
      normals[v] = unit_or_up(normals[v]);
    }
    return normals;
  }

  void write_voxel_normals(StructureIndex structure, const StructureCrop& crop,
                           const SmoothGradient& gradient, std::int64_t k) const {
    for (std::int64_t j = 1; j + 1 < crop.size[1]; ++j) {
      for (std::int64_t i = 1; i + 1 < crop.size[0]; ++i) {
        if (crop.inside[crop.offset(i, j, k)] == 0) continue;
        const auto voxel =
            static_cast<std::size_t>(grid_.offset(i + crop.first[0], j + crop.first[1], k + crop.first[2]));
        if (normal_owner_[classification_.volume[voxel]] != structure) continue;
        const Vec3f inwards = frame_.gradient_to_lps(gradient.at(i, j));
        normals_[voxel] = pack_normal({-inwards[0], -inwards[1], -inwards[2]});
      }
    }
  }

  const Classification& classification_;
  const Grid& grid_;
  IndexFrame frame_;
  std::span<const StructureIndex> normal_owner_;
  std::span<PackedNormal> normals_;
};

/// Per class the structure whose normal its voxels take: the first of which they are boundary.
std::vector<StructureIndex> find_normal_owners(const ClassTable& classes) {
  std::vector<StructureIndex> owners(classes.size(), kNoStructure);
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.part == Part::kBoundary && owners[c] == kNoStructure) owners[c] = m.structure;
    }
  }
  return owners;
}

/// Structures with voxels, those with the largest boxes first, so that threads end together.
std::vector<std::pair<StructureIndex, IndexBox>> structures_to_extract(const ClassTable& classes,
                                                                       const StructureGraph& graph) {
  std::vector<IndexBox> boxes(graph.size());
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.part != Part::kCrossed) boxes[m.structure].include(classes.box(c));
    }
  }
  std::vector<std::pair<StructureIndex, IndexBox>> result;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    if (!boxes[s].empty()) result.emplace_back(s, boxes[s]);
  }
  const auto voxels = [](const IndexBox& box) {
    return (box.last[0] - box.first[0] + 1) * (box.last[1] - box.first[1] + 1) *
           (box.last[2] - box.first[2] + 1);
  };
  std::stable_sort(result.begin(), result.end(),
                   [&](const auto& a, const auto& b) { return voxels(a.second) > voxels(b.second); });
  return result;
}

std::vector<std::vector<PackedNormal>> gather_by_class(const Classification& classification,
                                                       std::span<const StructureIndex> owners,
                                                       std::span<const PackedNormal> normals) {
  std::vector<std::vector<PackedNormal>> result(owners.size());
  for (ClassId c = 0; c < owners.size(); ++c) {
    if (owners[c] != kNoStructure) result[c].reserve(classification.classes.voxels(c));
  }
  for (std::size_t v = 0; v < classification.volume.size(); ++v) {
    const ClassId c = classification.volume[v];
    if (owners[c] != kNoStructure) result[c].push_back(normals[v]);
  }
  return result;
}

}  // namespace

ExtractedSurfaces extract_surfaces(const Classification& classification, const StructureGraph& graph,
                                   const Grid& storage_grid, unsigned threads,
                                   const std::function<void(double)>& progress) {
  ExtractedSurfaces result;
  result.surfaces.resize(graph.size());
  const std::vector<StructureIndex> owners = find_normal_owners(classification.classes);
  std::vector<PackedNormal> normals(classification.volume.size());
  const StructureExtractor extractor(classification, storage_grid, owners, normals);
  const auto structures = structures_to_extract(classification.classes, graph);

  parallel_for(
      structures.size(), threads,
      [&](std::size_t n) {
        const auto& [structure, box] = structures[n];
        result.surfaces[structure] = extractor.extract(structure, box);
      },
      [&](std::size_t done) {
        if (progress) progress(static_cast<double>(done) / static_cast<double>(structures.size()));
      });
  result.boundary_normals = gather_by_class(classification, owners, normals);
  return result;
}

}  // namespace splatlas
