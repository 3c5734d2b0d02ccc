#include "preprocess/surfaces/vtk_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

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

Triangle smallest_rotation(const Triangle& t) {
  return std::min({t, Triangle{t[1], t[2], t[0]}, Triangle{t[2], t[0], t[1]}});
}

std::vector<Triangle> as_set(std::vector<Triangle> triangles) {
  for (Triangle& triangle : triangles) triangle = smallest_rotation(triangle);
  std::ranges::sort(triangles);
  return triangles;
}

/// Sorts triangles by the leading voxel of their cell, then by cell.
class CellOrder {
 public:
  CellOrder(const StructureCrop& crop, const SurfaceMesh& mesh) : crop_(crop), mesh_(mesh) {}

  void sort(std::vector<Triangle>& triangles) const {
    std::ranges::stable_sort(triangles, {}, [this](const Triangle& triangle) { return place_of(triangle); });
  }

 private:
  /// Offsets in the crop of the leading voxel plus 1, or 0, and of the cell.
  [[nodiscard]] std::pair<std::size_t, std::size_t> place_of(const Triangle& triangle) const {
    Index3 cell{};
    for (std::size_t a = 0; a < 3; ++a) {
      float low = mesh_.positions_ijk[triangle[0]][a];
      for (const std::uint32_t v : triangle) low = std::min(low, mesh_.positions_ijk[v][a]);
      cell[a] = static_cast<std::int64_t>(std::floor(low)) - crop_.first[a];
    }
    for (std::int64_t corner = 0; corner < 8; ++corner) {
      const std::size_t at =
          crop_.offset(cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
      if (crop_.parts[at] == StructureCrop::kBoundary)
        return {at + 1, crop_.offset(cell[0], cell[1], cell[2])};
    }
    return {0, crop_.offset(cell[0], cell[1], cell[2])};
  }

  const StructureCrop& crop_;
  const SurfaceMesh& mesh_;
};

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

}  // namespace

Result<EdgeTriangles> extract_with_vtk(const StructureCrop& crop) {
  static_assert(StructureCrop::kOutside < 0.5 && StructureCrop::kInterior > 0.5 &&
                StructureCrop::kBoundary > 0.5);
  return extract_contour<vtkUnsignedCharArray>(crop, std::span(crop.parts), 0.5);
}

Result<EdgeTriangles> extract_zeros_with_vtk(const StructureCrop& crop, std::span<const float> field) {
  return extract_contour<vtkFloatArray>(crop, field, 0);
}

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

Result<bool> adopt_triangles(const EdgeTriangles& vtk, const StructureCrop& crop, const Grid& grid,
                             SurfaceMesh& mesh) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::uint32_t> vertex_of, match_vertices(vtk, crop, mesh));
  if (as_set(renumbered(vtk, vertex_of, grid)) == as_set(mesh.triangles)) return true;
  mesh.triangles = renumbered(vtk, vertex_of, grid);
  CellOrder(crop, mesh).sort(mesh.triangles);
  return false;
}

}  // namespace splatlas
