#include "preprocess/surfaces/vtk_surface.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include "format/derive/fit_surface.h"
#include "format/result_macros.h"
#include "preprocess/import/quiet_vtk.h"

namespace splatlas {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Vertices of a mesh by the voxel edges that they lie on.
class VertexFinder {
 public:
  VertexFinder(const StructureCrop& crop, const SurfaceMesh& mesh) : crop_(crop) {
    for (std::uint32_t v = 0; v < mesh.positions_ijk.size(); ++v)
      found_.emplace_back(edge_of(mesh.positions_ijk[v]), v);
    std::ranges::sort(found_);
  }
  [[nodiscard]] std::optional<std::uint32_t> find(const std::array<float, 3>& position) const {
    const std::size_t edge = edge_of(position);
    const auto at = std::ranges::lower_bound(found_, edge, {}, &std::pair<std::size_t, std::uint32_t>::first);
    if (at == found_.end() || at->first != edge) return std::nullopt;
    return at->second;
  }

 private:
  /// Four times the offset of its first voxel, plus its axis: one coordinate lies strictly between voxels.
  [[nodiscard]] std::size_t edge_of(const std::array<float, 3>& position) const {
    Index3 voxel;
    std::size_t axis = 3;
    for (std::size_t a = 0; a < 3; ++a) {
      voxel[a] = static_cast<std::int64_t>(std::floor(position[a])) - crop_.first[a];
      if (std::floor(position[a]) != position[a]) axis = a;
    }
    return 4 * crop_.offset(voxel[0], voxel[1], voxel[2]) + axis;
  }

  const StructureCrop& crop_;
  std::vector<std::pair<std::size_t, std::uint32_t>> found_;
};

/// [vertex of VTK]: the vertex of `mesh`, the surface of `crop`, between the same two voxels. kFailed if
/// there is none. Cost: n log n for n vertices.
Result<std::vector<std::uint32_t>> match_vertices(const EdgeTriangles& vtk, const StructureCrop& crop,
                                                  const SurfaceMesh& mesh) {
  const VertexFinder finder(crop, mesh);
  std::vector<std::uint32_t> vertex_of(vtk.positions_ijk.size());
  for (std::size_t v = 0; v < vertex_of.size(); ++v) {
    const std::optional<std::uint32_t> vertex = finder.find(vtk.positions_ijk[v]);
    if (!vertex) {
      const auto& [i, j, k] = vtk.positions_ijk[v];
      return fail(ErrorCode::kFailed,
                  "VTK's surface has a vertex at ({}, {}, {}), where no voxel edge crosses it", i, j, k);
    }
    vertex_of[v] = *vertex;
  }
  return vertex_of;
}

std::vector<Triangle> as_set(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles) t = std::min({t, Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[0], t[1]}});
  std::ranges::sort(triangles);
  return triangles;
}

/// Sort key of a triangle: offset in the crop of its cell's leading voxel plus 1, or 0; then the cell's.
std::pair<std::size_t, std::size_t> place_of(const Triangle& triangle, const StructureCrop& crop,
                                             const SurfaceMesh& mesh) {
  Index3 cell{};
  for (std::size_t a = 0; a < 3; ++a) {
    float low = mesh.positions_ijk[triangle[0]][a];
    for (const std::uint32_t v : triangle) low = std::min(low, mesh.positions_ijk[v][a]);
    cell[a] = static_cast<std::int64_t>(std::floor(low)) - crop.first[a];
  }
  const std::size_t offset = crop.offset(cell[0], cell[1], cell[2]);
  for (std::int64_t corner = 0; corner < 8; ++corner) {
    const std::size_t at =
        crop.offset(cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
    if (crop.parts[at] == StructureCrop::kBoundary) return {at + 1, offset};
  }
  return {0, offset};
}

/// Appends VTK's surface, whose first slice is slice `first` of the crop.
Result<void> append(vtkPolyData& found, const StructureCrop& crop, std::int64_t first, EdgeTriangles& all) {
  const std::array<double, 3> origin{static_cast<double>(crop.first[0]), static_cast<double>(crop.first[1]),
                                     static_cast<double>(crop.first[2] + first)};
  const auto first_vertex = static_cast<std::uint32_t>(all.positions_ijk.size());
  for (vtkIdType v = 0; v < found.GetNumberOfPoints(); ++v) {
    const double* const point = found.GetPoint(v);
    std::array<float, 3>& position = all.positions_ijk.emplace_back();
    for (std::size_t a = 0; a < 3; ++a) position[a] = static_cast<float>(point[a] + origin[a]);
  }
  vtkCellArray& cells = *found.GetPolys();
  for (vtkIdType t = 0; t < cells.GetNumberOfCells(); ++t) {
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    cells.GetCellAtId(t, count, corners);
    if (count != 3) return fail(ErrorCode::kFailed, "VTK's surface has a polygon of {} corners", count);
    Triangle& triangle = all.triangles.emplace_back();
    for (std::size_t n = 0; n < 3; ++n) triangle[n] = first_vertex + static_cast<std::uint32_t>(corners[n]);
  }
  return {};
}

/// The contour of scalars on the voxels of a crop, slab by slab: VTK takes tens of bytes for each.
template <typename VtkArray, typename T>
Result<EdgeTriangles> extract_contour(const StructureCrop& crop, std::span<const T> scalars, double value) {
  constexpr std::int64_t kSlabVoxels = std::int64_t{1} << 24;
  const std::int64_t plane = crop.size[0] * crop.size[1];
  const std::int64_t cells = std::max<std::int64_t>(1, kSlabVoxels / plane);  // along z
  EdgeTriangles result;
  for (std::int64_t first = 0; first + 1 < crop.size[2]; first += cells) {
    const std::int64_t slices = std::min(cells + 1, crop.size[2] - first);
    const auto slab =
        scalars.subspan(static_cast<std::size_t>(first * plane), static_cast<std::size_t>(slices * plane));
    vtkNew<VtkArray> array;
    array->SetArray(const_cast<T*>(slab.data()), slices * plane, 1);  // VTK does not write to its input
    vtkNew<vtkImageData> image;
    image->SetDimensions(static_cast<int>(crop.size[0]), static_cast<int>(crop.size[1]),
                         static_cast<int>(slices));
    image->GetPointData()->SetScalars(array);
    vtkNew<vtkFlyingEdges3D> extract;
    extract->SetInputData(image);
    extract->SetValue(0, value);
    extract->ComputeNormalsOff();
    extract->ComputeGradientsOff();
    extract->ComputeScalarsOff();
    if (const std::string fault = update_quietly(*extract); !fault.empty())
      return fail(ErrorCode::kFailed, "VTK cannot extract the surface: {}", fault);
    SPLATLAS_RETURN_IF_ERROR(append(*extract->GetOutput(), crop, first, result));
  }
  return result;
}

/// VTK's triangles between the vertices of a mesh of the grid.
std::vector<Triangle> renumbered(const EdgeTriangles& vtk, std::span<const std::uint32_t> vertex_of,
                                 const Grid& grid) {
  const bool mirrored = determinant(index_to_lps_mm(grid).linear) < 0;
  std::vector<Triangle> triangles = vtk.triangles;
  for (Triangle& triangle : triangles) {
    for (std::uint32_t& v : triangle) v = vertex_of[v];
    if (mirrored) std::swap(triangle[1], triangle[2]);
  }
  return triangles;
}

using Vec3f = std::array<float, 3>;

/// Grey values of type T, less the level of an isosurface.
template <typename T>
class LevelField {
 public:
  LevelField(const VoxelBuffer& values, double level, const Grid& grid)
      : values_(values.as<T>()), level_(level), grid_(grid) {}

  /// nullopt beyond the grid and for values that are not finite.
  [[nodiscard]] std::optional<double> at(const Index3& voxel) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (voxel[a] < 0 || voxel[a] >= grid_.size[a]) return std::nullopt;
    }
    const auto value =
        static_cast<double>(values_[static_cast<std::size_t>(grid_.offset(voxel[0], voxel[1], voxel[2]))]);
    if (!std::isfinite(value)) return std::nullopt;
    return value - level_;
  }

  /// Calls visit(tap, value) along i, with the grid's border repeated, and 0 for values that are not finite.
  template <std::size_t kTaps, typename Visit>
  void visit_row(std::int64_t i, std::int64_t j, std::int64_t k, const Visit& visit) const {
    const auto& [ni, nj, nk] = grid_.size;
    const T* const row = values_ + grid_.offset(0, std::clamp<std::int64_t>(j, 0, nj - 1),
                                                std::clamp<std::int64_t>(k, 0, nk - 1));
    for (std::size_t n = 0; n < kTaps; ++n) {
      const auto at = std::clamp<std::int64_t>(i + static_cast<std::int64_t>(n), 0, ni - 1);
      const auto value = static_cast<double>(row[at]);
      visit(n, std::isfinite(value) ? value - level_ : 0);
    }
  }

 private:
  const T* values_;
  double level_;
  const Grid& grid_;
};

/// The field on a crop, with the signs of the mask: positive inside, negative outside.
template <typename T>
std::vector<float> signed_field(const LevelField<T>& field, const StructureCrop& crop) {
  constexpr double kMin = std::numeric_limits<float>::min(), kMax = 1e30;
  std::vector<float> result(crop.parts.size());
  std::size_t n = 0;
  for (std::int64_t k = 0; k < crop.size[2]; ++k) {
    for (std::int64_t j = 0; j < crop.size[1]; ++j) {
      for (std::int64_t i = 0; i < crop.size[0]; ++i, ++n) {
        const double value = field.at({i + crop.first[0], j + crop.first[1], k + crop.first[2]}).value_or(0);
        const bool inside = crop.parts[n] != StructureCrop::kOutside;
        result[n] =
            static_cast<float>(inside ? std::clamp(value, kMin, kMax) : std::clamp(value, -kMax, -kMin));
      }
    }
  }
  return result;
}

/// Weights of a Gaussian, and of its derivative, around a position on an axis.
struct GaussianTaps {
  static constexpr std::int64_t kTaps = 12;
  static constexpr double kSigma = 1.75;  // voxels
  std::int64_t first = 0;
  std::array<double, kTaps> gauss{}, derivative{};

  explicit GaussianTaps(double position)
      : first(static_cast<std::int64_t>(std::floor(position)) - kTaps / 2 + 1) {
    for (std::size_t n = 0; n < gauss.size(); ++n) {
      const double t = static_cast<double>(first) + static_cast<double>(n) - position;
      gauss[n] = std::exp(-0.5 * t * t / (kSigma * kSigma));
      derivative[n] = t * gauss[n];
    }
  }
};

/// Gradient per voxel, but for a factor, of the smoothed field. Less smoothing shows the slices of CT as
/// terraces, because values change within one slice there.
template <typename T>
Vec3 smooth_gradient(const LevelField<T>& field, const Vec3& position) {
  const std::array<GaussianTaps, 3> taps{GaussianTaps(position[0]), GaussianTaps(position[1]),
                                         GaussianTaps(position[2])};
  Vec3 gradient{0, 0, 0};
  for (std::size_t k = 0; k < GaussianTaps::kTaps; ++k) {
    for (std::size_t j = 0; j < GaussianTaps::kTaps; ++j) {
      double smooth = 0, along_i = 0;
      field.template visit_row<GaussianTaps::kTaps>(
          taps[0].first, taps[1].first + static_cast<std::int64_t>(j),
          taps[2].first + static_cast<std::int64_t>(k), [&](std::size_t i, double value) {
            smooth += taps[0].gauss[i] * value;
            along_i += taps[0].derivative[i] * value;
          });
      gradient[0] += taps[1].gauss[j] * taps[2].gauss[k] * along_i;
      gradient[1] += taps[1].derivative[j] * taps[2].gauss[k] * smooth;
      gradient[2] += taps[1].gauss[j] * taps[2].derivative[k] * smooth;
    }
  }
  return gradient;
}

/// Turns a normal down the gradient. Keeps one whose sign the gradient contradicts.
template <typename T>
void turn(const LevelField<T>& field, const VoxelNormals& lps_normals, const Vec3f& position, Vec3f& normal) {
  const Vec3 up = smooth_gradient(field, {position[0], position[1], position[2]});
  const double length = std::max({std::abs(up[0]), std::abs(up[1]), std::abs(up[2])});
  if (!(length > 0) || !std::isfinite(length)) return;
  Vec3f down;
  for (std::size_t a = 0; a < 3; ++a) down[a] = static_cast<float>(-up[a] / length);
  const Vec3f turned = lps_normals.to_lps(down);
  if (turned[0] * normal[0] + turned[1] * normal[1] + turned[2] * normal[2] > 0) normal = turned;
}

/// Moves a vertex to an isosurface. kFailed if `found`, VTK's vertex, is not between the voxels of `edge`.
template <typename T>
Result<void> move_vertex(const LevelField<T>& field, const VoxelNormals& lps_normals, const VoxelEdge& edge,
                         const Vec3f& found, Vec3f& position, Vec3f& normal) {
  constexpr double kRounding = 1e-2;  // VTK's positions are single precision
  const double t = static_cast<double>(found[edge.axis]) - static_cast<double>(edge.low[edge.axis]);
  bool is_on_edge = t >= -kRounding && t <= 1 + kRounding;
  for (std::size_t a = 0; a < 3; ++a) {
    is_on_edge = is_on_edge && (a == edge.axis || found[a] == static_cast<float>(edge.low[a]));
  }
  if (!is_on_edge) {
    return fail(ErrorCode::kFailed, "VTK's isosurface has a vertex at ({}, {}, {}), off its voxel edge",
                found[0], found[1], found[2]);
  }
  const std::optional<double> low = field.at(edge.low), high = field.at(edge.high);
  if (!low || !high || (*low >= 0) == (*high >= 0)) return {};
  constexpr double kScale = kIsosurfaceScale;
  const double rounded = std::clamp(std::round(t * kScale), 1.0, kScale - 1) / kScale;
  position[edge.axis] = static_cast<float>(static_cast<double>(edge.low[edge.axis]) + rounded);
  turn(field, lps_normals, position, normal);
  return {};
}

}  // namespace

Result<EdgeTriangles> extract_with_vtk(const StructureCrop& crop) {
  static_assert(StructureCrop::kOutside < 0.5 && StructureCrop::kInterior > 0.5 &&
                StructureCrop::kBoundary > 0.5);
  return extract_contour<vtkUnsignedCharArray>(crop, std::span(crop.parts), 0.5);
}

Result<bool> adopt_triangles(const EdgeTriangles& vtk, const StructureCrop& crop, const Grid& grid,
                             SurfaceMesh& mesh) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::uint32_t> vertex_of, match_vertices(vtk, crop, mesh));
  if (as_set(renumbered(vtk, vertex_of, grid)) == as_set(mesh.triangles)) return true;
  mesh.triangles = renumbered(vtk, vertex_of, grid);
  std::ranges::stable_sort(mesh.triangles, {}, [&](const Triangle& t) { return place_of(t, crop, mesh); });
  return false;
}

Result<void> move_to_isosurface(const VoxelBuffer& values, double level, const StructureCrop& crop,
                                const Grid& grid, const EdgeTriangles& vtk, SurfaceMesh& mesh) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::uint32_t> vertex_of, match_vertices(vtk, crop, mesh));
  return visit_voxel_type(values.type, [&]<typename T>(T) -> Result<void> {
    const LevelField<T> field(values, level, grid);
    // In the order of extract_with_vtk() for the mask of the inside voxels
    const std::vector<float> around_zero = signed_field(field, crop);
    SPLATLAS_ASSIGN_OR_RETURN(const EdgeTriangles zeros,
                              extract_contour<vtkFloatArray>(crop, std::span(around_zero), 0));
    if (zeros.triangles != vtk.triangles || zeros.positions_ijk.size() != vtk.positions_ijk.size()) {
      return fail(ErrorCode::kFailed, "VTK's isosurface has {} triangles, that of its voxels {} others",
                  zeros.triangles.size(), vtk.triangles.size());
    }
    const VoxelNormals lps_normals(grid);
    for (std::size_t v = 0; v < vertex_of.size(); ++v) {
      SPLATLAS_RETURN_IF_ERROR(move_vertex(field, lps_normals, VoxelEdge(vtk.positions_ijk[v]),
                                           zeros.positions_ijk[v], mesh.positions_ijk[vertex_of[v]],
                                           mesh.normals_lps[vertex_of[v]]));
    }
    mesh.position_scale = kIsosurfaceScale;
    round_normals(mesh.normals_lps);
    return {};
  });
}

}  // namespace splatlas
