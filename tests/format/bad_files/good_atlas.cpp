#include "tests/format/bad_files/good_atlas.h"

#include <vector>

#include "tests/support/fill_classes.h"
#include "tests/support/fit_parts.h"

namespace splatlas {
namespace {

constexpr Index3 kSize{10, 5, 4};

struct Box {
  Index3 first, last;
  [[nodiscard]] bool holds(const Index3& at) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (at[a] < first[a] || at[a] > last[a]) return false;
    }
    return true;
  }
};

constexpr Box kCoreBox{{1, 1, 0}, {3, 3, 2}}, kRimBox{{3, 1, 0}, {4, 3, 2}}, kKnobBox{{6, 1, 0}, {8, 3, 2}},
    kNeedleBox{{0, 0, 3}, {5, 0, 3}};

std::vector<Membership> members_of(const Index3& at) {
  std::vector<Membership> members;
  const auto add = [&](StructureIndex s, const Box& box) {
    const auto holds = [&](const Index3& voxel) { return box.holds(voxel); };
    if (holds(at)) members.push_back({s, is_boundary(at, holds) ? Part::kBoundary : Part::kInterior});
  };
  add(good::kCore, kCoreBox);
  add(good::kRim, kRimBox);
  if (kNeedleBox.holds(at)) members.push_back({good::kNeedle, Part::kCrossed});
  add(good::kKnob, kKnobBox);
  return members;
}

SurfaceMesh one_triangle(std::uint32_t position_scale) {
  SurfaceMesh mesh;
  mesh.position_scale = position_scale;
  mesh.positions_ijk = {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {2, 2, 2}};
  mesh.normals_lps.assign(4, {0, 0, 1});
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  return mesh;
}

/// Surfaces of core and knob and the normals of the knob are derived; the others are stored.
void add_surfaces(AtlasContent& content) {
  content.surfaces.resize(content.graph.size());
  content.surfaces[good::kRim] = one_triangle(2);
  content.surfaces[good::kNeedle] = one_triangle(8192);
  content.boundary_normals.resize(content.classes.size());
  fit_parts(content, good::kCore);
  fit_parts(content, good::kKnob);
  const std::vector<StructureIndex> owners = normal_owners(content.classes);
  for (ClassId c = 0; c < owners.size(); ++c) {
    if (owners[c] != good::kKnob) content.boundary_normals[c].clear();
  }
  for (std::size_t v = 0; v < content.class_volume.size(); ++v) {
    const ClassId c = content.class_volume[v];
    if (owners[c] != kNoStructure && owners[c] != good::kKnob) {
      content.boundary_normals[c].push_back(static_cast<PackedNormal>(v * 257));
    }
  }
}

}  // namespace

AtlasContent good_content() {
  AtlasContent content;
  content.source_grid.size = kSize;
  content.source_grid.spacing_mm = {1, 1.5, 2};
  content.graph = StructureGraph::build({{"all", "All", {200, 200, 200}},
                                         {"core", "Core", {1, 2, 3}, 7, {good::kAll}},
                                         {"rim", "Rim", {4, 5, 6}, -8, {good::kAll, good::kCore}},
                                         {"needle", "Needle", {7, 8, 9}, {}, {}, true},
                                         {"knob", "Knob", {10, 11, 12}, 9, {good::kAll}}})
                      .value();
  fill_classes(content, members_of);
  content.values = {VoxelType::kUInt8, {}};
  for (int v = 0; v < 200; ++v) content.values.bytes.push_back(static_cast<std::byte>(v * 37 % 251));
  content.label_type = VoxelType::kInt16;
  add_surfaces(content);
  content.display = {10, 240, {4, 3, 3}, 9};
  content.scenes = {{"First", "A caption.", "core:both", 30, 20, 1.5}};
  content.provenance = {"Good", "Nobody 2020", "CC0", "splatlas", {{"labels", "xxh64:0123456789abcdef"}}};
  return content;
}

}  // namespace splatlas
