#include "player/render/decode/class_cache.h"

#include <cstring>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "format/atlas_writer.h"
#include "tests/support/random_scene.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

void expect_equal(const AtlasContent& content, const ClassCache& cache, std::span<const ClassId> classes,
                  Axis axis) {
  const Grid grid = storage_grid(content);
  const RunModel model = encode_runs(content.class_volume, grid.size, axis, content.classes.size());
  const std::size_t bytes = bytes_of(content.values.type);
  std::vector<std::size_t> met(content.classes.size(), 0);
  for (std::size_t n = 0; n < content.class_volume.size(); ++n) {
    const ClassId c = content.class_volume[n];
    const std::size_t number = met[c]++;
    if (std::find(classes.begin(), classes.end(), c) == classes.end()) continue;
    if (bytes > 0) {
      ASSERT_EQ(std::memcmp(cache.values() + n * bytes, content.values.bytes.data() + n * bytes, bytes), 0);
    }
    if (!content.boundary_normals[c].empty()) {
      ASSERT_EQ(cache.lights()[n], (VoxelLight{content.boundary_normals[c][number], VoxelLight::kAllLit}));
    }
  }
  const auto rows = static_cast<std::uint64_t>(grid.size[ScanOrder::of(axis).row_axis]);
  std::map<ClassId, ClassRuns> held;
  for (std::int64_t slice = 0; slice < grid.size[ScanOrder::of(axis).slice_axis]; ++slice) {
    for (const ClassRun& run : cache.runs(axis).slice(slice))
      held[run.id].push_back({static_cast<std::uint64_t>(slice) * rows + run.row, run.start, run.length});
  }
  for (const ClassId c : classes) {
    ASSERT_EQ(held[c], model.classes[c]);
    ASSERT_EQ(cache.run_count(c, axis), model.classes[c].size());
  }
}

TEST(ClassCache, HoldsWhatTheAtlasHolds) {
  for (std::uint32_t number = 0; number < 60; ++number) {
    const RandomScene scene = random_scene(number);
    const auto atlas = open_in_memory(scene.content);
    ThreadPool pool(3);
    ClassCache cache(atlas);
    std::vector<ClassId> some;
    std::vector<ClassId> all;
    for (ClassId c = 1; c < atlas->classes().size(); ++c) {
      all.push_back(c);
      if ((c + number) % 2 == 0) some.push_back(c);
    }
    for (const auto& [classes, axis] :
         {std::pair(some, Axis::kY), {some, Axis::kX}, {all, Axis::kX}, {all, Axis::kZ}}) {
      ASSERT_TRUE(cache.require(classes, axis, pool));
      expect_equal(scene.content, cache, classes, axis);
    }
    std::vector<StructureIndex> structures;
    for (StructureIndex s = 0; s < atlas->graph().size(); ++s) structures.push_back(s);
    ASSERT_TRUE(cache.require_surfaces(structures, pool));
    ClassCache other(atlas);  // shares the surfaces
    ASSERT_TRUE(other.require_surfaces(structures, pool));
    for (const StructureIndex s : structures) {
      ASSERT_EQ(cache.surface(s).mesh, scene.content.surfaces[s]);
      ASSERT_EQ(&other.surface(s), &cache.surface(s));
    }
    cache.begin(std::span(structures).first(1), ~std::uint64_t{0});
    cache.begin({}, 76 * cache.surface(0).mesh.triangles.size());  // keeps the latest one
    for (const StructureIndex s : structures)
      ASSERT_EQ(cache.has_surface(s, 0), s == 0 || scene.content.surfaces[s].empty());
  }
}

struct EncodedScene {
  AtlasContent content = random_scene(3, 16).content;
  std::vector<std::byte> bytes = encode_atlas(content).value();
  std::vector<ClassId> all = std::vector<ClassId>(content.classes.size() - 1);

  EncodedScene() { std::iota(all.begin(), all.end(), 1); }
  [[nodiscard]] std::shared_ptr<const Atlas> open() const { return Atlas::open_bytes(bytes).value(); }
};

TEST(ClassCache, ReadsNothingTwiceAndNothingElse) {
  const EncodedScene scene;
  const auto atlas = scene.open();
  ASSERT_GE(atlas->classes().size(), 5u);
  const std::vector<ClassId> some{2, 4};
  ThreadPool pool(2);
  ClassCache cache(atlas);
  ASSERT_TRUE(cache.require(some, Axis::kZ, pool));
  const Atlas::Counters first = atlas->counters();

  const auto other = scene.open();
  for (const ClassId c : some) {
    (void)other->read_runs(c, Axis::kZ);
    (void)other->read_values(c);
    (void)other->read_normals(c);
  }
  EXPECT_EQ(first.read, other->counters().read);
  EXPECT_EQ(first.decoded, other->counters().decoded);

  ASSERT_TRUE(cache.require(some, Axis::kZ, pool));
  EXPECT_EQ(atlas->counters().decoded, first.decoded);
  ASSERT_TRUE(cache.require(some, Axis::kX, pool));
  for (const ClassId c : some) (void)other->read_runs(c, Axis::kX);
  EXPECT_EQ(atlas->counters().decoded, other->counters().decoded);
}

/// Unneeded parts are not read: no normals without shading, and along y only runs.
TEST(ClassCache, ReadsNormalsOnlyWhereTheyAreWanted) {
  const EncodedScene scene;
  const std::vector<ClassId>& all = scene.all;
  const auto atlas = scene.open(), other = scene.open();
  ThreadPool pool(2);
  ClassCache cache(atlas);
  ASSERT_TRUE(cache.require(all, Axis::kY, pool, VoxelParts::kValues));
  EXPECT_EQ(cache.lights(), nullptr);
  for (const ClassId c : all) {
    (void)other->read_runs(c, Axis::kY);
    (void)other->read_values(c);
  }
  EXPECT_EQ(atlas->counters().read, other->counters().read);
  EXPECT_EQ(atlas->counters().decoded, other->counters().decoded);

  for (const Axis axis : {Axis::kX, Axis::kY}) {  // along x none are cached yet
    ASSERT_TRUE(cache.require(all, axis, pool));
    expect_equal(scene.content, cache, all, axis);
  }
}

/// Small classes share chunks: the first thread decodes them for all.
TEST(ClassCache, DecodesAsMuchWithManyThreadsAsWithOne) {
  const EncodedScene scene;
  const auto decoded = [&](unsigned threads) {
    const auto atlas = scene.open();
    ThreadPool pool(threads);
    ClassCache cache(atlas);
    EXPECT_TRUE(cache.require(scene.all, Axis::kX, pool));
    return atlas->counters().decoded;
  };
  const std::uint64_t expected = decoded(1);
  for (std::uint32_t n = 0; n < repetitions(300); ++n) ASSERT_EQ(decoded(8), expected) << "try " << n;
}

TEST(ClassCache, DamageIsToldAndNothingOfTheDamagedClassIsKept) {
  const EncodedScene scene;
  ThreadPool pool(2);
  std::size_t failures = 0;
  for (std::size_t at = 0; at < scene.bytes.size(); at += 1 + scene.bytes.size() / 100) {
    auto damaged = scene.bytes;
    damaged[at] ^= std::byte{0x10};
    const auto atlas = Atlas::open_bytes(std::move(damaged));
    if (!atlas) continue;
    ClassCache cache(*atlas);
    for (const Axis axis : kAxes) {
      const auto first = cache.require(scene.all, axis, pool);
      const auto again = cache.require(scene.all, axis, pool);
      EXPECT_EQ(first.has_value(), again.has_value()) << "a damaged class was kept";
      if (!first) {
        ++failures;
        EXPECT_EQ(first.error().code, ErrorCode::kInvalidAtlas);
      } else {
        expect_equal(scene.content, cache, scene.all, axis);
      }
    }
  }
  EXPECT_GT(failures, 5u);
}

}  // namespace
}  // namespace splatlas
