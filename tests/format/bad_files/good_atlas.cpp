#include "tests/format/bad_files/good_atlas.h"

#include <utility>
#include <vector>

#include "format/derive/fit_surface.h"
#include "format/derive/structure_crop.h"
#include "format/run_model.h"
#include "tests/support/neighbours.h"

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

void classify(AtlasContent& content) {
  ClassTable classes;
  for (std::int64_t k = 0; k < kSize[2]; ++k) {
    for (std::int64_t j = 0; j < kSize[1]; ++j) {
      for (std::int64_t i = 0; i < kSize[0]; ++i) {
        const ClassId c = classes.intern(members_of({i, j, k}));
        classes.count(c, 1, {{i, j, k}, {i, j, k}});
        content.class_volume.push_back(c);
      }
    }
  }
  const std::vector<ClassId> order = storage_order(classes, content.graph);
  std::vector<ClassId> number(order.size());
  for (ClassId c = 0; c < order.size(); ++c) number[order[c]] = c;
  for (ClassId& c : content.class_volume) c = number[c];
  content.classes = classes.renumbered(order);
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
  const Grid grid = storage_grid(content);
  content.surfaces.resize(content.graph.size());
  content.surfaces[good::kRim] = one_triangle(2);
  content.surfaces[good::kNeedle] = one_triangle(8192);
  content.boundary_normals.resize(content.classes.size());
  const StructureClasses held(content.classes, content.graph.size());
  for (const auto& [s, box] : {std::pair{good::kCore, kCoreBox}, std::pair{good::kKnob, kKnobBox}}) {
    const std::vector<std::uint8_t> parts = parts_of(held.of(s), content.classes.size());
    const StructureCrop crop = crop_structure(content.class_volume, kSize, {box.first, box.last}, parts);
    content.surfaces[s] = fit_surface(crop, grid);
  }
  const std::vector<StructureIndex> owners = normal_owners(content.classes);
  for (std::size_t v = 0; v < content.class_volume.size(); ++v) {
    const ClassId c = content.class_volume[v];
    if (owners[c] != kNoStructure && owners[c] != good::kKnob) {
      content.boundary_normals[c].push_back(static_cast<PackedNormal>(v * 257));
    }
  }
  StructureCrop knob = empty_crop_around({kKnobBox.first, kKnobBox.last});
  const RunModel runs = encode_runs(content.class_volume, kSize, Axis::kZ, content.classes.size());
  const std::vector<std::uint8_t> parts = parts_of(held.of(good::kKnob), content.classes.size());
  for (ClassId c = 1; c < parts.size(); ++c) paint_runs(runs.classes[c], kSize[1], parts[c], knob);
  for (ClassId c = 1; c < parts.size(); ++c) {
    if (owners[c] == good::kKnob) content.boundary_normals[c] = fit_normals(knob, runs.classes[c], grid);
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
  classify(content);
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
