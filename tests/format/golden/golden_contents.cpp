#include "tests/format/golden/golden_contents.h"

#include "tests/format/bad_files/good_atlas.h"
#include "tests/support/fit_parts.h"

namespace splatlas {
namespace {

/// The good atlas with values of another type.
AtlasContent with_values(VoxelType type) {
  AtlasContent content = good_content();
  content.values = {type, {}};
  for (std::size_t n = 0; n < content.class_volume.size() * bytes_of(type); ++n) {
    content.values.bytes.push_back(static_cast<std::byte>(n * n * 31 % 253));
  }
  return content;
}

/// One empty voxel.
AtlasContent nothing() {
  AtlasContent content;
  content.source_grid.size = {1, 1, 1};
  content.class_volume = {kEmptyClass};
  content.classes.count(kEmptyClass, 1, {{0, 0, 0}, {0, 0, 0}});
  content.boundary_normals.resize(1);
  return content;
}

/// Scenes with all keys.
AtlasContent scenes() {
  AtlasContent content = nothing();
  content.scenes = {{"All", "A\ncaption.", "*", 30, 20, 1.5, "Why?", "left=1", "1,2,3", true, {"core", "#2"}},
                    {"Least", "", "*"}};
  return content;
}

/// A mirrored, rotated and sheared grid, stored in another axis order.
AtlasContent turned() {
  AtlasContent content = nothing();
  content.source_grid = {{2, 3, 4}, {0.5, 1, 2}, {-10, 20, 30.25}, {0.1, 0, -1, -1, 0.1, 0, 0, 1, 0}};
  content.source_to_storage = storage_order(content.source_grid);
  content.class_volume.assign(24, kEmptyClass);
  const Index3 size = storage_grid(content).size;
  content.classes.count(kEmptyClass, 23, {{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}});
  content.values = {VoxelType::kInt16, {}};
  for (std::size_t n = 0; n < 48; ++n) content.values.bytes.push_back(static_cast<std::byte>(5 * n));
  return content;
}

}  // namespace

std::vector<GoldenContent> golden_contents() {
  std::vector<GoldenContent> contents{{"good", good_content()},
                                      {"compact", good_content(), true},
                                      {"means", good_content(), false, 1},
                                      {"surfaces", fitted_by_all_rules(good_content(), 2)},
                                      {"nothing", nothing()},
                                      {"scenes", scenes()},
                                      {"turned", turned()}};
  for (int type = 0; type <= static_cast<int>(VoxelType::kFloat64); ++type) {
    const auto voxel_type = static_cast<VoxelType>(type);
    contents.push_back({std::string(name_of(voxel_type)), with_values(voxel_type)});
  }
  return contents;
}

}  // namespace splatlas
