#include "tests/support/standard_scenes.h"

#include <algorithm>
#include <cmath>

#include "tests/support/phantom_content.h"

namespace splatlas {
namespace {

TestVolume phantom_volume() {
  TestVolume volume;
  volume.grid.size = {phantom::kSize, phantom::kSize, phantom::kSize};
  const std::array<Rgb, 2> colors{Rgb{240, 150, 110}, Rgb{120, 180, 250}};
  for (std::size_t n = 0; n < 2; ++n) {
    volume.structures.push_back({n == 0 ? "first" : "second", phantom_mask(phantom::kBalls[n]), colors[n]});
  }
  volume.values = make_values(VoxelType::kUInt8, phantom::values());
  volume.window_high = 250;
  return volume;
}

StandardScene scene_of(const char* name, const TestVolume& volume, const char* selection) {
  StandardScene scene{name, make_content(volume), {}};
  scene.selection = selection_of(selection, scene.content.graph);
  return scene;
}

}  // namespace

StandardScene phantom_scene() {
  return scene_of("phantom", phantom_volume(), "*:volume(opacity=0.3)");
}

StandardScene blobs_scene() {
  constexpr std::int64_t kSide = 40;
  struct Blob {
    double x, y, z, width;
  };
  const std::array<Blob, 4> blobs{Blob{14, 15, 18, 5}, {26, 20, 15, 4}, {20, 27, 25, 6}, {22, 12, 29, 3}};
  std::vector<float> values;
  TestVolume volume;
  volume.grid.size = {kSide, kSide, kSide};
  const auto mask = make_mask(volume.grid.size, [&](auto i, auto j, auto k) {
    double sum = 0;
    for (const Blob& blob : blobs) {
      const double x = (static_cast<double>(i) - blob.x) / blob.width;
      const double y = (static_cast<double>(j) - blob.y) / blob.width;
      const double z = (static_cast<double>(k) - blob.z) / blob.width;
      sum += std::exp(-0.5 * (x * x + y * y + z * z));
    }
    values.push_back(static_cast<float>(sum));
    return true;
  });
  volume.structures = {{"blobs", mask, {230, 200, 160}}};
  volume.values = make_values(VoxelType::kFloat32, values);
  volume.window_low = 0.02;
  volume.window_high = 1.2;
  return scene_of("blobs", volume, "blobs(opacity=0.3)");
}

StandardScene labels_scene() {
  TestVolume volume;
  volume.grid.size = {28, 28, 28};
  volume.structures = {{"box", box_mask(volume.grid.size, {4, 6, 4}, {11, 27, 21}), {250, 80, 60}},
                       {"ball", ball_mask(volume.grid.size, {16, 16, 16}, 9 * 9), {80, 230, 90}},
                       {"core", ball_mask(volume.grid.size, {17, 17, 17}, 4 * 4), {90, 110, 250}}};
  return scene_of("labels", volume, "*:volume(opacity=0.9)");
}

StandardScene hybrid_scene() {
  TestVolume volume = phantom_volume();
  const auto hull = [](auto i, auto j, auto k) {
    return std::min({i, j, k}) > 0 && std::max({i, j, k}) < phantom::kSize - 1 && i + j + k > 12 &&
           i + j + k < 84;
  };
  volume.structures.push_back({"hull", make_mask(volume.grid.size, hull), {220, 220, 200}});
  return scene_of(
      "hybrid", volume,
      "first:volume(opacity=0.2) + first:surface + second:both(opacity=0.3) + hull:surface(opacity=0.15)");
}

}  // namespace splatlas
