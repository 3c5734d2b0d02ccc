#include "format/derive/fit_surface.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/file/fitted_content.h"
#include "tests/format/random_content.h"
#include "tests/format/random_volume.h"
#include "tests/support/fill_classes.h"
#include "tests/support/fit_parts.h"

namespace splatlas {
namespace {

std::uint64_t section_bytes(const Atlas& atlas, const std::string& name) {
  for (const SectionSize& section : atlas.sections()) {
    if (section.name == name) return section.bytes;
  }
  return 0;
}

RC_GTEST_PROP(FitSurface, WhatFollowsFromTheVoxelsIsNotStoredAndComesBack, ()) {
  auto random = *random_source();
  const AtlasContent content = fitted_by_all_rules(random_content(random, {9, 5, 30}));
  const RunModel runs =
      encode_runs(content.class_volume, storage_grid(content).size, Axis::kZ, content.classes.size());
  const FittedParts parts = find_fitted_parts(content, runs, 1);
  const StructureClasses held(content.classes, content.graph.size());
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    const bool holds_voxels = !box_of(content.classes, held.of(s)).empty();
    RC_ASSERT((parts.surfaces[s].triangles > 0) == holds_voxels);
  }
  for (ClassId c = 0; c < content.classes.size(); ++c)
    RC_ASSERT(parts.normals[c] == (normal_owner(content.classes.members(c)) != kNoStructure));
  for (const bool compact : {false, true}) {
    const auto atlas = *Atlas::open_bytes(*encode_atlas(content, {.compact = compact, .threads = 1}));
    RC_ASSERT(atlas->verify().has_value());
    if (compact) RC_ASSERT(section_bytes(*atlas, "normals") == 0);
    const AtlasContent back = *atlas->read_all();
    RC_ASSERT(back.surfaces == content.surfaces);
    RC_ASSERT(back.boundary_normals == content.boundary_normals);
  }
}

/// A ball of one structure in a grid of its own.
AtlasContent ball() {
  AtlasContent content;
  content.source_grid.size = {12, 13, 14};
  content.graph = *StructureGraph::build({{.id = "ball"}});
  const auto holds = [](const Index3& at) {
    const auto [i, j, k] = at;
    return (i - 5) * (i - 5) + (j - 6) * (j - 6) + (k - 6) * (k - 6) < 25;
  };
  fill_classes(content, [&](const Index3& at) -> std::vector<Membership> {
    if (!holds(at)) return {};
    return {{0, is_boundary(at, holds) ? Part::kBoundary : Part::kInterior}};
  });
  content.surfaces.resize(1);
  content.boundary_normals.resize(3);
  return content;
}

TEST(FitSurface, ABallTakesNoBytesAndOneNormalThatDiffersCostsAllOfItsClass) {
  AtlasContent content = fitted(ball(), SurfaceRule::kUneven);
  const auto whole = *Atlas::open_bytes(*encode_atlas(content));
  EXPECT_EQ(section_bytes(*whole, "surfaces"), 0u);
  EXPECT_EQ(section_bytes(*whole, "normals"), 0u);
  EXPECT_EQ(whole->triangles(0), content.surfaces[0].triangles.size());
  EXPECT_GT(whole->triangles(0), 100u);

  content.boundary_normals[2][3] ^= 1;
  std::swap(content.surfaces[0].triangles[0], content.surfaces[0].triangles[1]);
  const auto stored = *Atlas::open_bytes(*encode_atlas(content, {.compact = true}));
  EXPECT_GT(section_bytes(*stored, "surfaces"), 0u);
  EXPECT_GT(section_bytes(*stored, "normals"), 0u);
  EXPECT_EQ(*stored->read_normals(2), content.boundary_normals[2]);
  EXPECT_EQ(*stored->read_surface(0), content.surfaces[0]);  // as of earlier writers
  EXPECT_TRUE(stored->has_levels(0));
}

/// The structure's runs in the z model of the content.
PartRows rows_of(const AtlasContent& content, const RunModel& runs, StructureIndex s) {
  PartRows rows(storage_grid(content).size);
  const StructureClasses held(content.classes, content.graph.size());
  for (const auto& [c, part] : held.of(s)) rows.add(runs.classes[c], StructureCrop::part_of(part));
  rows.sort();
  return rows;
}

RC_GTEST_PROP(FitSurface, SparseFitsHaveTheSameBits, ()) {
  auto random = *random_source();
  const AtlasContent content = fitted_by_all_rules(random_content(random, {9, 7, 30}));
  const Grid grid = storage_grid(content);
  const RunModel runs = encode_runs(content.class_volume, grid.size, Axis::kZ, content.classes.size());
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    const PartRows rows = rows_of(content, runs, s);
    if (rows.rows().empty()) continue;
    const SurfaceMesh& surface = content.surfaces[s];
    const auto rule = static_cast<SurfaceRule>(surface.position_scale);
    RC_ASSERT(fit_sparse_surface(rows, grid, rule, surface.triangles.size()) == surface);
    RC_ASSERT(!fit_sparse_surface(rows, grid, rule, surface.triangles.size() - 1).has_value());
    for (ClassId c = 1; c < content.classes.size(); ++c) {
      if (normal_owner(content.classes.members(c)) != s) continue;
      RC_ASSERT(fit_sparse_normals(rows, runs.classes[c], grid) == content.boundary_normals[c]);
    }
  }
}

RC_GTEST_PROP(FitSurface, SparseFitsOfWrongPartsHaveTheSameBits, ()) {
  auto random = *random_source();
  Grid grid;
  for (auto& n : grid.size) n = 1 + static_cast<std::int64_t>(below(8, random));
  const std::vector<ClassId> parts = random_classes(grid.size, 3, random);  // 0: outside
  const RunModel runs = encode_runs(parts, grid.size, Axis::kZ, 3);
  StructureCrop crop = empty_crop({{0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1}});
  PartRows rows(grid.size);
  for (const std::uint8_t part : {StructureCrop::kInterior, StructureCrop::kBoundary}) {
    paint_runs(runs.classes[part], grid.size[1], part, crop);
    rows.add(runs.classes[part], part);
  }
  rows.sort();
  for (const SurfaceRule rule : {SurfaceRule::kVoxels, SurfaceRule::kSmooth, SurfaceRule::kUneven}) {
    const SurfaceMesh surface = fit_surface(crop, grid, rule);
    RC_ASSERT(fit_sparse_surface(rows, grid, rule, surface.triangles.size()) == surface);
  }
}

TEST(FitSurface, CellsWithoutABoundaryVoxelComeFirst) {
  const Grid grid{.size = {9, 4, 1}};
  StructureCrop crop = empty_crop({{0, 0, 0}, {8, 3, 0}});
  PartRows rows(grid.size);
  const auto add = [&](const splatlas::Run& run, std::uint8_t part) {
    paint_runs({&run, 1}, grid.size[1], part, crop);
    rows.add({&run, 1}, part);
  };
  add({0, 0, 1}, StructureCrop::kBoundary);
  add({0, 7, 1}, StructureCrop::kInterior);
  add({3, 4, 1}, StructureCrop::kInterior);
  rows.sort();
  const SurfaceMesh surface = fit_surface(crop, grid, SurfaceRule::kSmooth);
  EXPECT_TRUE(fit_sparse_surface(rows, grid, SurfaceRule::kSmooth, surface.triangles.size()) == surface);
  ASSERT_EQ(surface.triangles.size(), 24u);  // 8 cells of one triangle around each voxel
  // Below the voxels, then above them: cells in memory order, those of the boundary voxel last
  std::vector<float> voxel_of_triangle;
  for (const auto& triangle : surface.triangles) {
    float i = 0;
    for (const std::uint32_t vertex : triangle) i += surface.positions_ijk[vertex][0];
    voxel_of_triangle.push_back(std::round(i / 3));
  }
  EXPECT_EQ(voxel_of_triangle, (std::vector<float>{7, 7, 7, 7, 4, 4, 4, 4, 7, 7, 7, 7, 4, 4, 4, 4,  //
                                                   0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(FitSurface, NormalsOfAClassNeedTheOwnersOtherClassesAround) {
  const AtlasContent content = fitted(ball());
  const Grid grid = storage_grid(content);
  const RunModel runs = encode_runs(content.class_volume, grid.size, Axis::kZ, 3);
  const auto normals = [&](bool with_interior) {
    StructureCrop crop = crop_around(content.classes.box(2));
    if (with_interior) paint_runs(runs.classes[1], grid.size[1], StructureCrop::kInterior, crop);
    paint_runs(runs.classes[2], grid.size[1], StructureCrop::kBoundary, crop);
    return fit_normals(crop, runs.classes[2], grid);
  };
  EXPECT_EQ(normals(true), content.boundary_normals[2]);
  EXPECT_NE(normals(false), content.boundary_normals[2]);
}

/// Structure 0 has the part of structure 1, the corners or all voxels of a box, and voxels at `distance` from
/// one of its faces.
AtlasContent part_and_neighbours(std::int64_t distance, bool is_sparse, std::mt19937& random) {
  constexpr std::int64_t kSide = 22, kFirst = 7, kLast = 14;
  AtlasContent content;
  content.source_grid.size = {kSide, kSide, kSide};
  content.graph = *StructureGraph::build({{.id = "all"}, {.id = "part"}});
  std::vector<bool> part, all;
  const std::size_t axis = below(3, random);
  const std::int64_t slice = below(2, random) == 0 ? kFirst - distance : kLast + distance;
  for_each_voxel(content.source_grid.size, [&](const Index3& at) {
    const auto inside = [&](std::int64_t n) { return n >= kFirst && n <= kLast; };
    const auto is_corner = [&](std::int64_t n) { return n == kFirst || n == kLast; };
    part.push_back(is_sparse ? std::ranges::all_of(at, is_corner) : std::ranges::all_of(at, inside));
    all.push_back(part.back() || (at[axis] == slice && below(3, random) == 0));
  });
  const auto holds_all = holds_in(all, content.source_grid.size);
  const auto holds_part = holds_in(part, content.source_grid.size);
  fill_classes(content, [&](const Index3& at) {
    std::vector<Membership> members;
    if (holds_all(at)) members.push_back({0, is_boundary(at, holds_all) ? Part::kBoundary : Part::kInterior});
    if (holds_part(at))
      members.push_back({1, is_boundary(at, holds_part) ? Part::kBoundary : Part::kInterior});
    return members;
  });
  content.surfaces.resize(2);
  content.boundary_normals.resize(content.classes.size());
  return fitted(std::move(content));
}

RC_GTEST_PROP(FitSurface, NormalsOfAClassNeedTheOwnersVoxelsUpToThreeVoxelsAway, ()) {
  auto random = *random_source();
  for (std::int64_t distance = 1; distance <= 4; ++distance) {
    for (const bool is_sparse : {true, false}) {
      const AtlasContent content = part_and_neighbours(distance, is_sparse, random);
      const auto full = *Atlas::open_bytes(*encode_atlas(content, {.compact = false, .threads = 1}));
      const auto compact = *Atlas::open_bytes(*encode_atlas(content, {.compact = true, .threads = 1}));
      RC_ASSERT(section_bytes(*full, "normals") > 0);
      RC_ASSERT(section_bytes(*compact, "normals") == 0);
      bool fits_as_expected = false;  // classes of few voxels may be sparse in a dense part
      for (ClassId c = 0; c < content.classes.size(); ++c) {
        if (content.classes.members(c).size() == 2) {
          fits_as_expected = fits_as_expected ||
                             fits_sparsely(content.classes.box(c), content.classes.voxels(c)) == is_sparse;
        }
        RC_ASSERT(*full->read_normals(c) == content.boundary_normals[c]);
        RC_ASSERT(*compact->read_normals(c) == content.boundary_normals[c]);
      }
      RC_ASSERT(fits_as_expected);
    }
  }
}

TEST(FitSurface, CropsAreCountedWithWhatNormalsDependOn) {
  const IndexBox box{{0, 0, 0}, {0, 1, 2}};
  EXPECT_EQ(crop_voxels(box), 7u * 8 * 9);
  EXPECT_EQ(crop_around(box).parts.size(), crop_voxels(box));
  EXPECT_EQ(box_of(crop_around(box)), around(box));
}

TEST(PaintRuns, ClipsAtTheCrop) {
  StructureCrop crop = empty_crop({{2, 2, 2}, {3, 3, 3}});  // 1 to 4 on every axis
  const ClassRuns runs{{2 * 9 + 2, 0, 3}, {2 * 9 + 3, 4, 8}, {0, 0, 9}, {2 * 9 + 8, 2, 1}, {8 * 9 + 2, 2, 1}};
  paint_runs(runs, 9, StructureCrop::kBoundary, crop);
  std::vector<std::size_t> painted;
  for (std::size_t n = 0; n < crop.parts.size(); ++n) {
    if (crop.parts[n] != StructureCrop::kOutside) painted.push_back(n);
  }
  EXPECT_EQ(painted,
            (std::vector<std::size_t>{crop.offset(0, 1, 1), crop.offset(1, 1, 1), crop.offset(3, 2, 1)}));
}

}  // namespace
}  // namespace splatlas
