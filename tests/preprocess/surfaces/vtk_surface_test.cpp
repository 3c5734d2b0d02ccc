#include "preprocess/surfaces/vtk_surface.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkMarchingCubes.h>
#include <vtkMarchingCubesTriangleCases.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/derive/fit_surface.h"
#include "format/derive/surface_net.h"
#include "preprocess/surfaces/extract_surfaces.h"
#include "tests/format/derive/masks.h"
#include "tests/preprocess/random_images.h"
#include "tests/support/message_of.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

template <typename Corner>
std::array<Corner, 3> smallest_rotation(const std::array<Corner, 3>& t) {
  return std::min({t, std::array<Corner, 3>{t[1], t[2], t[0]}, std::array<Corner, 3>{t[2], t[0], t[1]}});
}

TEST(CellCases, AreTheOrientedTrianglesOfVtk) {
  // Corners and edges of VTK's hexahedron
  constexpr std::array<unsigned, 8> kCorner{0, 1, 3, 2, 4, 5, 7, 6};
  constexpr std::array<std::array<unsigned, 2>, 12> kEdge{
      {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6}, {7, 6}, {4, 7}, {0, 4}, {1, 5}, {3, 7}, {2, 6}}};
  const auto number = [&](int edge) {
    const unsigned a = kCorner[kEdge[static_cast<std::size_t>(edge)][0]],
                   b = kCorner[kEdge[static_cast<std::size_t>(edge)][1]];
    const unsigned axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
    return number_of({static_cast<std::uint8_t>(a & b), static_cast<std::uint8_t>(axis)});
  };
  const vtkMarchingCubesTriangleCases* const cases = vtkMarchingCubesTriangleCases::GetCases();
  using Triangles = std::multiset<std::array<std::size_t, 3>>;
  for (unsigned n = 0; n < 256; ++n) {
    unsigned inside = 0;
    for (unsigned corner = 0; corner < 8; ++corner) inside |= (n >> corner & 1u) << kCorner[corner];
    Triangles of_vtk, ours;
    for (const int* edge = cases[n].edges; *edge >= 0; edge += 3)
      of_vtk.insert(smallest_rotation(std::array{number(edge[0]), number(edge[1]), number(edge[2])}));
    const CellCase& of = cell_cases()[inside];
    for (std::size_t t = 0; t < of.triangle_count; ++t) {
      const auto& [a, b, c] = of.triangles[t];
      ours.insert(smallest_rotation(std::array<std::size_t, 3>{of.edges[a], of.edges[b], of.edges[c]}));
    }
    EXPECT_EQ(ours, of_vtk) << inside;
  }
}

/// Positions of the corners of triangles, as a set of oriented triangles.
using Triangles = std::multiset<std::array<std::array<float, 3>, 3>>;

template <typename Mesh>
Triangles triangles_of(const Mesh& mesh) {
  Triangles triangles;
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.insert(
        smallest_rotation(std::array{mesh.positions_ijk[a], mesh.positions_ijk[b], mesh.positions_ijk[c]}));
  }
  return triangles;
}

/// The surface of a mask by vtkMarchingCubes.
Triangles marching_cubes_of(const Mask& mask) {
  vtkNew<vtkImageData> image;
  vtkNew<vtkUnsignedCharArray> scalars;
  const auto size = [&](std::size_t a) { return static_cast<int>(mask.size[a]) + 2; };
  image->SetDimensions(size(0), size(1), size(2));
  image->SetOrigin(-1, -1, -1);
  for (std::int64_t k = -1; k <= mask.size[2]; ++k) {
    for (std::int64_t j = -1; j <= mask.size[1]; ++j) {
      for (std::int64_t i = -1; i <= mask.size[0]; ++i)
        scalars->InsertNextValue(mask.holds({i, j, k}) ? 1 : 0);
    }
  }
  image->GetPointData()->SetScalars(scalars);
  vtkNew<vtkMarchingCubes> filter;
  filter->SetInputData(image);
  filter->SetValue(0, 0.5);
  filter->Update();
  Triangles triangles;
  vtkPolyData& found = *filter->GetOutput();
  for (vtkIdType t = 0; t < found.GetNumberOfCells(); ++t) {
    std::array<std::array<float, 3>, 3> corners{};
    for (int n = 0; n < 3; ++n) {
      const double* const point = found.GetPoint(found.GetCell(t)->GetPointId(n));
      for (std::size_t a = 0; a < 3; ++a)
        corners[static_cast<std::size_t>(n)][a] = static_cast<float>(point[a]);
    }
    triangles.insert(smallest_rotation(corners));
  }
  return triangles;
}

Mask noise(std::mt19937& random, std::int64_t side) {
  const auto density = 2 + random() % 69;
  return mask_of({side, side, side}, [&](auto, auto, auto) { return random() % 100 < density; });
}

TEST(AdoptTriangles, KeepsASurfaceWithTheTrianglesOfVtk) {
  std::mt19937 random(3);
  for (const bool mirrored : {false, true}) {
    const StructureCrop crop = crop_of(noise(random, 6));
    const Grid grid{.size = {6, 6, 6}, .direction_lps = {mirrored ? -1. : 1., 0, 0, 0, 1, 0, 0, 0, 1}};
    for (const SurfaceRule rule : {SurfaceRule::kVoxels, SurfaceRule::kSmooth}) {
      const SurfaceMesh fitted = fit_surface(crop, grid, rule);
      SurfaceMesh mesh = fitted;
      EXPECT_TRUE(value_or_throw(adopt_triangles(value_or_throw(extract_with_vtk(crop)), crop, grid, mesh)));
      EXPECT_EQ(mesh, fitted);
    }
  }
}

TEST(AdoptTriangles, FindsTheTrianglesOfVtkAcrossItsSlabs) {
  std::mt19937 random(4);
  const Index3 size{1024, 1024, 35};  // slabs have 16 slices
  StructureCrop crop = empty_crop({{0, 0, 0}, {1023, 1023, 34}});
  for (std::int64_t k = 1; k <= size[2]; ++k) {
    for (std::int64_t j = 1; j < 10; ++j) {
      for (std::int64_t i = 1; i < 10; ++i) {
        if (random() % 3 == 0) crop.parts[crop.offset(i, j, k)] = StructureCrop::kBoundary;
      }
    }
  }
  const Grid grid{.size = size};
  SurfaceMesh mesh = fit_surface(crop, grid, SurfaceRule::kVoxels);
  const EdgeTriangles vtk = value_or_throw(extract_with_vtk(crop));
  EXPECT_EQ(vtk.triangles.size(), mesh.triangles.size());
  EXPECT_GT(vtk.positions_ijk.size(), mesh.positions_ijk.size());  // slabs share slices
  EXPECT_TRUE(value_or_throw(adopt_triangles(vtk, crop, grid, mesh)));
}

/// Turns the diagonal of two triangles in a cell.
void flip_diagonals(SurfaceMesh& mesh) {
  std::size_t flipped = 0;
  for (std::size_t t = 0; t + 1 < mesh.triangles.size(); ++t) {
    auto &one = mesh.triangles[t], &next = mesh.triangles[t + 1];
    for (std::size_t n = 0; n < 9; ++n) {
      const std::array abc{one[n / 3], one[(n / 3 + 1) % 3], one[(n / 3 + 2) % 3]};
      const std::array acd{next[n % 3], next[(n % 3 + 1) % 3], next[(n % 3 + 2) % 3]};
      if (abc[0] != acd[0] || abc[2] != acd[1]) continue;
      bool same_cell = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto [low, high] = std::minmax({mesh.positions_ijk[abc[0]][a], mesh.positions_ijk[abc[1]][a],
                                              mesh.positions_ijk[abc[2]][a], mesh.positions_ijk[acd[2]][a]});
        same_cell = same_cell && high - low <= 1 && std::floor(low) + 1 >= high;
      }
      if (!same_cell) continue;
      one = {abc[0], abc[1], acd[2]};
      next = {abc[1], abc[2], acd[2]};
      ++flipped;
      ++t;
      break;
    }
  }
  ASSERT_GT(flipped, 50u);
}

TEST(AdoptTriangles, TakesTrianglesThatDoNotFollowFromTheVoxels) {
  std::mt19937 random(5);
  const Mask mask = noise(random, 6);
  const StructureCrop crop = crop_of(mask);
  const Grid grid{.size = {6, 6, 6}};
  SurfaceMesh flipped = fit_surface(crop, grid, SurfaceRule::kVoxels);
  flip_diagonals(flipped);
  EdgeTriangles other{flipped.positions_ijk, flipped.triangles};
  std::ranges::reverse(other.triangles);
  SurfaceMesh mesh = fit_surface(crop, grid, SurfaceRule::kSmooth);
  EXPECT_FALSE(value_or_throw(adopt_triangles(other, crop, grid, mesh)));
  // Vertices between the same voxels are the same in all meshes, with other numbers. Cells have one order.
  const auto edges_of = [](const SurfaceMesh& of) {
    std::vector<std::multiset<std::array<std::array<float, 3>, 3>>> cells;
    for (const auto& [a, b, c] : of.triangles) {
      std::array<std::array<float, 3>, 3> corners{of.positions_ijk[a], of.positions_ijk[b],
                                                  of.positions_ijk[c]};
      for (auto& corner : corners) {
        for (float& x : corner) x = x == std::floor(x) ? x : std::floor(x) + 0.5f;
      }
      cells.push_back({smallest_rotation(corners)});
    }
    return cells;
  };
  const auto expected = edges_of(flipped), found = edges_of(mesh);
  ASSERT_EQ(found.size(), expected.size());
  const auto all = [](const auto& lists) {
    std::multiset<std::array<std::array<float, 3>, 3>> set;
    for (const auto& list : lists) set.insert(list.begin(), list.end());
    return set;
  };
  EXPECT_EQ(all(found), all(expected));
  // Cells are in the order of the fitted mesh.
  const auto cell_of = [](const std::multiset<std::array<std::array<float, 3>, 3>>& triangle) {
    std::array<float, 3> low = (*triangle.begin())[0];
    for (const auto& corner : *triangle.begin()) {
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], corner[a]);
    }
    for (float& x : low) x = std::floor(x);
    return low;
  };
  for (std::size_t t = 0; t < found.size(); ++t) EXPECT_EQ(cell_of(found[t]), cell_of(expected[t]));
}

TEST(AdoptTriangles, RefusesAVertexThatNoVoxelEdgeHas) {
  const Mask mask = mask_of({3, 3, 3}, [](auto, auto, auto) { return true; });
  const StructureCrop crop = crop_of(mask);
  const Grid grid{.size = {3, 3, 3}};
  SurfaceMesh mesh = fit_surface(crop, grid, SurfaceRule::kSmooth);
  EdgeTriangles vtk = value_or_throw(extract_with_vtk(crop));
  vtk.positions_ijk[0] = {1, 1, 0.5f};
  EXPECT_EQ(message_of(adopt_triangles(vtk, crop, grid, mesh)),
            "VTK's surface has a vertex at (1, 1, 0.5), where no voxel edge crosses it");
}

/// A random label volume of several structures with ambiguous cells.
Masks random_labels(std::mt19937& random, const Index3& size) {
  const auto labels = 1 + random() % 4, background = random() % 80;
  Masks masks(labels);
  for (std::int64_t n = 0; n < size[0] * size[1] * size[2]; ++n) {
    const bool is_empty = random() % 100 < background;
    const auto label = random() % labels;
    for (std::size_t s = 0; s < labels; ++s) masks[s].push_back(!is_empty && s == label ? 1 : 0);
  }
  return masks;
}

TEST(ExtractSurfaces, DecodedTrianglesAreVtksInRandomLabelVolumes) {
  std::mt19937 random(11);
  std::size_t structures = 0;
  for (int n = 0; n < 300; n += kEveryNth) {
    AtlasContent content;
    for (std::int64_t& side : content.source_grid.size) side = 1 + static_cast<std::int64_t>(random() % 9);
    const Grid& grid = content.source_grid;
    const Masks masks = random_labels(random, grid.size);
    content.graph = flat_graph(masks.size());
    ClassifiedVoxels classification =
        value_or_throw(classify_voxels(memberships_of(masks, grid.size), {}, content.graph, 1));
    for (const SurfaceRule rule : {SurfaceRule::kSmooth, SurfaceRule::kVoxels}) {
      ExtractedSurfaces extracted =
          value_or_throw(extract_surfaces(classification, content.graph, grid, {rule, 1, {}}));
      EXPECT_EQ(extracted.not_derived, 0u);
      content.classes = classification.classes;
      content.class_volume = volume_of(classification, grid.size);
      content.surfaces = std::move(extracted.surfaces);
      content.boundary_normals = std::move(extracted.boundary_normals);
      const auto bytes = value_or_throw(encode_atlas(content, {.level = 1, .threads = 1}));
      const auto atlas =
          value_or_throw(Atlas::open_bytes(bytes, "(memory)", {.surfaces = SurfaceChoice::kVoxels}));
      for (StructureIndex s = 0; s < masks.size(); ++s) {
        const SurfaceMesh mesh = value_or_throw(atlas->read_surface(s));
        EXPECT_EQ(triangles_of(mesh), marching_cubes_of(Mask{grid.size, masks[s]})) << n << ", " << s;
        ++structures;
      }
    }
  }
  EXPECT_GT(structures, 300u);
}

}  // namespace
}  // namespace splatlas
