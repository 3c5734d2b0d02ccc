#include "tests/campaigns/faults/small_atlas.h"

#include <random>

#include "tests/support/fit_parts.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

constexpr std::int64_t kSide = 10;

}  // namespace

AtlasContent small_atlas(unsigned seed) {
  TestVolume volume;
  volume.grid.size = {kSide, kSide, kSide};
  const auto box = [&](std::int64_t from, std::int64_t to) {
    return make_mask(volume.grid.size, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      return i >= from && i < to && j > 0 && j < 8 && k > 1 && k < 8;
    });
  };
  const auto ball = make_mask(volume.grid.size, [](std::int64_t i, std::int64_t j, std::int64_t k) {
    return (i - 5) * (i - 5) + (j - 6) * (j - 6) + (k - 5) * (k - 5) < 9;
  });
  volume.structures.push_back({.id = "boxes", .mask = {}});
  volume.structures.push_back({.id = "left", .mask = box(1, 5), .color = {255, 0, 0}, .parents = {0}});
  volume.structures.push_back({.id = "right", .mask = box(5, 9), .color = {0, 255, 0}, .parents = {0}});
  volume.structures.push_back({.id = "ball", .mask = ball, .color = {0, 0, 255}});
  std::mt19937 random(seed);
  std::vector<std::uint8_t> greys;
  for (std::int64_t v = 0; v < volume.grid.voxels(); ++v)
    greys.push_back(static_cast<std::uint8_t>(random() % 256));
  volume.values = make_values(VoxelType::kUInt8, greys);
  volume.window_high = 255;
  AtlasContent content = make_content(volume);
  fit_parts(content, 1);
  return content;
}

}  // namespace splatlas
