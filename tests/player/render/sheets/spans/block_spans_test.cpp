#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "format/atlas_writer.h"
#include "format/derive/value_groups.h"
#include "player/render/sheets/spans/coarse_spans.h"
#include "tests/format/atlas_surgery.h"
#include "tests/player/prepared_selection.h"
#include "tests/player/render/sheets/spans/unpacked_spans.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

BlockSpans block_spans(PreparedSelection& prepared) {
  return {BlockVolume::read(prepared.atlas, prepared.plan, prepared.pool).value(), prepared.selection,
          *prepared.atlas};
}

/// Voxels of a group of classes in a block, and the sum of their values.
struct Part {
  std::uint32_t draw = 0;  // index into the plan's classes
  int voxels = 0;
  double sum = 0;
};

/// [block][structure]: parts by group. Voxel by voxel.
using Block = std::map<StructureIndex, std::map<std::uint32_t, Part>>;
std::vector<Block> parts_of(const AtlasContent& content, const DrawPlan& plan) {
  const ValueGroups groups(content.classes);
  const Grid grid = storage_grid(content), coarse = coarse_grid(grid, 2);
  std::map<ClassId, std::uint32_t> draws;
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    if (draws_volume(plan.classes[n].role)) draws[plan.classes[n].id] = n;
  }
  std::vector<Block> blocks(static_cast<std::size_t>(coarse.voxels()));
  std::size_t n = 0;
  for_each_voxel(grid.size, [&](const Index3& at) {
    const std::size_t voxel = n++;
    const auto found = draws.find(content.class_volume[voxel]);
    if (found == draws.end()) return;
    auto& block = blocks[static_cast<std::size_t>(coarse.offset(at[0] / 4, at[1] / 4, at[2] / 4))];
    Part& part = block[plan.classes[found->second].volume_of][groups.group_of[found->first]];
    part.draw = found->second;
    ++part.voxels;
    visit_voxel_type(content.values.type, [&](auto tag) {
      part.sum += static_cast<double>(content.values.as<decltype(tag)>()[voxel]);
    });
  });
  return blocks;
}

TEST(BlockSpans, HaveTheShareOfTheirVoxelsAndTheTransferOfTheMean) {
  std::uint64_t compared = 0;
  for (std::uint32_t number = 0; number < 30; ++number) {
    const RandomScene scene = random_scene(number, 20);
    if (scene.content.values.empty()) continue;
    SCOPED_TRACE(number);
    PreparedSelection prepared(scene.content, scene.selection, 2);
    BlockSpans spans = block_spans(prepared);
    const auto blocks = parts_of(scene.content, prepared.plan);
    for (const Axis axis : kAxes) {
      spans.prepare(axis, false, prepared.pool);
      const std::vector<reference::VoxelOptics> ours = unpacked(spans.model(), spans.grid());
      for (std::size_t n = 0; n < blocks.size(); ++n) {
        if (blocks[n].empty()) {
          ASSERT_EQ(ours[n].extinction, 0);
          continue;
        }
        const auto voxels_of = [](const auto& structure) {
          int voxels = 0;
          for (const auto& [group, part] : structure.second) voxels += part.voxels;
          return voxels;
        };
        int voxels = 0;
        for (const auto& structure : blocks[n]) voxels += voxels_of(structure);
        const auto& owner = std::ranges::max_element(blocks[n], {}, voxels_of)->second;
        const Part& most =
            std::ranges::max_element(owner, {}, [](const auto& of) { return of.second.voxels; })->second;
        visit_voxel_type(scene.content.values.type, [&](auto tag) {
          using T = decltype(tag);
          const double mean = most.sum / most.voxels;
          const T value =
              std::is_integral_v<T> ? static_cast<T>(std::floor(mean + 0.5)) : static_cast<T>(mean);
          float extinction = 0, white = 0;
          const VolumeAppearance& look = prepared.appearances.appearances()[most.draw];
          look.look_up(reinterpret_cast<const std::byte*>(&value), 0, 1, 1, &extinction, &white);
          const double share = voxels / 64.0;
          ASSERT_NEAR(ours[n].extinction, share * extinction, 1e-5 * extinction);
          for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(ours[n].emission[c], share * white * look.color[c], 1e-5 * white + 1e-30);
          ++compared;
        });
      }
    }
  }
  EXPECT_GT(compared, 1000u);
}

TestVolume volume_of(const Index3& size, std::vector<bool> mask, std::uint8_t grey) {
  TestVolume volume;
  volume.grid.size = size;
  volume.structures = {{"it", std::move(mask)}};
  volume.values =
      make_values(VoxelType::kUInt8, std::vector<std::uint8_t>(volume.structures[0].mask.size(), grey));
  volume.window_high = 255;
  return volume;
}

/// RMS of the errors of the lit emissions of a ball, from `rim` on: of the outermost voxels of a grid.
double light_error(const SpanModel& spans, const Grid& grid, const Vec3& middle, double rim,
                   const Lighting& lighting) {
  const std::vector<float> factors = lighting.table();
  const std::vector<reference::VoxelOptics> voxels = unpacked(spans, grid, factors);
  double sum = 0;
  int lit = 0;
  std::size_t n = 0;
  for_each_voxel(grid.size, [&](const Index3& at) {
    const reference::VoxelOptics& voxel = voxels[n++];
    std::array<float, 3> radial{};
    for (std::size_t a = 0; a < 3; ++a)
      radial[a] = static_cast<float>(static_cast<double>(at[a]) - middle[a]);
    if (std::hypot(radial[0], radial[1], radial[2]) < rim || voxel.extinction <= 0) return;
    const double error = voxel.emission[0] / voxel.extinction - factors[pack_normal(radial)];
    sum += error * error;
    ++lit;
  });
  EXPECT_GT(lit, 400);
  return std::sqrt(sum / lit);
}

TEST(BlockSpans, AreLitAsABallOfSuchVoxelsIs) {
  const Index3 size{96, 96, 96}, coarse{24, 24, 24};
  const AtlasContent content = make_content(volume_of(size, ball_mask(size, {48, 47, 49}, 40 * 40), 200));
  const AtlasContent of_blocks = make_content(volume_of(coarse, ball_mask(coarse, {12, 12, 12}, 100), 200));
  PreparedSelection prepared(content, selection_of("it:volume", content.graph));
  PreparedSelection alike(of_blocks, selection_of("it:volume", of_blocks.graph));
  BlockSpans spans = block_spans(prepared);
  const ParallelView view =
      *parallel_view({.azimuth_deg = 35, .elevation_deg = 50}, {64, 64}, content.display);
  const Lighting lighting(view);
  for (const Axis axis : kAxes) {
    spans.prepare(axis, true, prepared.pool);
    EXPECT_LT(light_error(spans.model(), spans.grid(), {11.625, 11.375, 11.875}, 9.5, lighting),
              1.1 * light_error(alike.spans(axis), alike.atlas->grid(), {12, 12, 12}, 9.5, lighting));
  }
}

/// Sum and middle of the opacities of a picture.
std::array<double, 3> opacity_of(const Picture& picture) {
  std::array<double, 3> sums{};
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      const auto opacity = static_cast<double>(picture.at(x, y)[3]);
      sums[0] += opacity;
      sums[1] += opacity * x;
      sums[2] += opacity * y;
    }
  }
  return {sums[0], sums[1] / sums[0], sums[2] / sums[0]};
}

TEST(BlockSpans, StandInForVoxelsThatTakeLongToDecode) {
  const Index3 size{180, 180, 178};
  TestVolume volume = volume_of(size, box_mask(size, {3, 2, 2}, {176, 175, 174}), 200);
  volume.structures.push_back({"ball", ball_mask(size, {90, 90, 90}, 400)});
  const AtlasContent content = make_content(volume);
  const Bytes file = encode_atlas(content, {.level = 1}).value();
  const Selection selection = selection_of("it:volume(opacity=0.02)", content.graph);
  Camera camera{.azimuth_deg = 40, .elevation_deg = 20};
  RenderOptions options{.size = {200, 200}, .quality = Quality::kDraft, .draft_budget_ms = 33};
  for (const auto projection : {CameraProjection::kPerspective, CameraProjection::kParallel}) {
    camera.projection = projection;
    options.draft_budget_ms = 33;
    Renderer renderer(Atlas::open_bytes(file).value(), {.threads = 1});
    ASSERT_TRUE(renderer.select(selection));
    const Frame first = frame_or_throw(renderer, camera, options);
    EXPECT_EQ(first.stats.rays, projection == CameraProjection::kPerspective);
    EXPECT_EQ(first.stats.level, 2);
    EXPECT_LT(renderer.atlas().counters().decoded, 500'000u);
    EXPECT_FALSE(first.picker(100, 100, {}));
    options.draft_budget_ms = 0;
    const Frame exact = frame_or_throw(renderer, camera, options);
    EXPECT_EQ(exact.stats.level, 0);
    EXPECT_GT(renderer.atlas().counters().decoded, 5'000'000u);
    EXPECT_TRUE(exact.picker(100, 100, {}));
    const auto [sum, x, y] = opacity_of(first.picture);
    const auto [exact_sum, exact_x, exact_y] = opacity_of(exact.picture);
    EXPECT_NEAR(sum / exact_sum, 1, 0.01);
    EXPECT_NEAR(x, exact_x, 0.1);
    EXPECT_NEAR(y, exact_y, 0.1);
    options.draft_budget_ms = 33;  // the voxels are decoded now
    EXPECT_LT(frame_or_throw(renderer, camera, options).stats.level, 2);
  }

  // A surface within blocks in perspective: its depths are in blocks
  camera.projection = CameraProjection::kPerspective;
  for (const char* text :
       {"it:volume(opacity=0.02) + ball:surface", "it:volume(opacity=0.02) + ball:surface(opacity=0.5)"}) {
    Renderer renderer(Atlas::open_bytes(file).value(), {.threads = 1});
    ASSERT_TRUE(renderer.select(selection_of(text, content.graph)));
    options.draft_budget_ms = 33;
    const Frame blocks = frame_or_throw(renderer, camera, options);
    EXPECT_EQ(blocks.stats.level, 2);
    options.draft_budget_ms = 0;
    const Frame exact = frame_or_throw(renderer, camera, options);
    const auto in_blocks = blocks.picture.at(100, 100), in_voxels = exact.picture.at(100, 100);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(in_blocks[c], in_voxels[c], 0.02) << text;
    EXPECT_NEAR(opacity_of(blocks.picture)[0] / opacity_of(exact.picture)[0], 1, 0.01);
  }
  options.draft_budget_ms = 33;

  // Damaged means: voxels are drawn instead. A damaged surface does not affect the blocks
  const auto damaged = [&](SectionKind kind) {
    AtlasParts parts = take_apart(file);
    std::size_t end = 0;
    for (const SectionEntry& section : parts.directory.sections) {
      end += section.chunks;
      if (section.kind == static_cast<std::uint32_t>(kind)) break;
    }
    parts.chunks[end - 1].back() ^= std::byte{1};
    return Atlas::open_bytes(put_together(parts)).value();
  };
  Renderer without_means(damaged(SectionKind::kMeans), {.threads = 1});
  ASSERT_TRUE(without_means.select(selection));
  const Frame voxels = frame_or_throw(without_means, camera, options);
  EXPECT_GT(without_means.atlas().counters().decoded, 5'000'000u);
  EXPECT_TRUE(voxels.missing.empty());
  Renderer without_surface(damaged(SectionKind::kSurfaces), {.threads = 1});
  ASSERT_TRUE(without_surface.select(selection_of("it:volume + ball:surface", content.graph)));
  for (const auto projection : {CameraProjection::kPerspective, CameraProjection::kParallel}) {
    camera.projection = projection;
    const Frame blocks = frame_or_throw(without_surface, camera, options);
    EXPECT_EQ(blocks.stats.level, 2);
    EXPECT_EQ(blocks.missing.size(), 1u);
  }
}

}  // namespace
}  // namespace splatlas
