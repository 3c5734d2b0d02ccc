#include "preprocess/classify/fragments.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/random_images.h"
#include "tests/support/fails_with.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

constexpr std::uint64_t kAll = 1'000'000;

/// [structure][voxel]: the masks of `memberships`.
Masks masks_of(const MembershipVolume& memberships, std::size_t structures) {
  Masks masks(structures, std::vector<std::uint8_t>(memberships.voxels().size()));
  for (std::size_t v = 0; v < memberships.voxels().size(); ++v) {
    for (const StructureIndex s : memberships.sets()[memberships.voxels()[v]]) masks[s][v] = 1;
  }
  return masks;
}

/// Sizes of the face-connected components by flood fill, and the same mask without its fragments.
std::vector<std::uint64_t> drop_by_flood_fill(std::vector<std::uint8_t>& mask, const Index3& size,
                                              std::uint64_t below) {
  std::vector<std::vector<std::size_t>> components;
  std::vector<std::uint8_t> left = mask;
  const auto offset = [&](const Index3& at) {
    return static_cast<std::size_t>((at[2] * size[1] + at[1]) * size[0] + at[0]);
  };
  for (std::size_t seed = 0; seed < left.size(); ++seed) {
    if (left[seed] == 0) continue;
    std::vector<std::size_t> found{seed};
    left[seed] = 0;
    for (std::size_t n = 0; n < found.size(); ++n) {
      const auto v = static_cast<std::int64_t>(found[n]);
      const Index3 at{v % size[0], v / size[0] % size[1], v / size[0] / size[1]};
      for (std::size_t a = 0; a < 3; ++a) {
        for (const std::int64_t step : {-1, 1}) {
          Index3 next = at;
          next[a] += step;
          if (next[a] < 0 || next[a] >= size[a] || left[offset(next)] == 0) continue;
          left[offset(next)] = 0;
          found.push_back(offset(next));
        }
      }
    }
    components.push_back(found);
  }
  std::size_t largest = 0;
  for (std::size_t n = 1; n < components.size(); ++n) {
    if (components[n].size() > components[largest].size()) largest = n;
  }
  std::vector<std::uint64_t> fragments;
  for (std::size_t n = 0; n < components.size(); ++n) {
    if (n == largest || components[n].size() >= below) continue;
    fragments.push_back(components[n].size());
    for (const std::size_t v : components[n]) mask[v] = 0;
  }
  return fragments;
}

TEST(Fragments, AreFoundByFacesOnly) {
  const Index3 size{5, 5, 5};
  // A bar of four voxels, one voxel at its edge and one at its corner.
  MembershipVolume volume = memberships_of({make_mask(size,
                                                      [](auto i, auto j, auto k) {
                                                        return (j == 1 && k == 1 && i < 4) ||
                                                               (i == 4 && j == 2 && k == 1) ||
                                                               (i == 4 && j == 0 && k == 2);
                                                      })},
                                           size);
  EXPECT_THAT(find_fragments(volume, std::vector<std::uint64_t>{2}),
              ElementsAre(StructureFragments{0, 2, 2}));
  EXPECT_THAT(find_fragments(volume, std::vector<std::uint64_t>{1}), IsEmpty());
  EXPECT_THAT(find_fragments(volume, std::vector<std::uint64_t>{0}), IsEmpty());
  EXPECT_THAT(find_fragments(volume, {}), IsEmpty());
}

TEST(Fragments, LargestComponentStaysHoweverSmall) {
  const Index3 size{7, 1, 1};
  MembershipVolume volume =
      memberships_of({make_mask(size, [](auto i, auto, auto) { return i % 2 == 0; })}, size);
  EXPECT_THAT(drop_fragments(volume, std::vector{kAll}), ElementsAre(StructureFragments{0, 3, 3}));
  EXPECT_THAT(masks_of(volume, 1)[0], ElementsAre(1, 0, 0, 0, 0, 0, 0));
}

TEST(Fragments, OnlyTheirStructureLosesTheVoxels) {
  const Index3 size{6, 1, 1};
  MembershipVolume volume = memberships_of({make_mask(size, [](auto i, auto, auto) { return i != 2; }),
                                            make_mask(size, [](auto, auto, auto) { return true; })},
                                           size);
  EXPECT_THAT(drop_fragments(volume, std::vector<std::uint64_t>{3, 3}),
              ElementsAre(StructureFragments{0, 1, 2}));
  EXPECT_THAT(masks_of(volume, 2)[0], ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_THAT(masks_of(volume, 2)[1], ElementsAre(1, 1, 1, 1, 1, 1));
}

TEST(Fragments, HolesGoToTheStructureAround) {
  const Index3 size{9, 5, 5};
  const auto in = [](auto i, auto j, auto k) { return i >= 1 && j >= 1 && j < 4 && k >= 1 && k < 4; };
  const auto crumb_of = [](auto i, auto j, auto k) { return j == 2 && k == 2 ? i : -1; };
  // A block of 0 and 1, with touching crumbs of 2 and 3 within, and one of 2 at its open end
  MembershipVolume volume = memberships_of(
      {make_mask(size, [&](auto i, auto j,
                           auto k) { return in(i, j, k) && i < 6 && (crumb_of(i, j, k) < 3 || i == 5); }),
       make_mask(size, [&](auto i, auto j, auto k) { return in(i, j, k) && i >= 6 && i < 8; }),
       make_mask(size,
                 [&](auto i, auto j, auto k) {
                   return crumb_of(i, j, k) == 3 || crumb_of(i, j, k) == 8 || (j == 0 && k == 0);
                 }),
       make_mask(size, [&](auto i, auto j, auto k) { return crumb_of(i, j, k) == 4 || (j == 4 && k == 4); })},
      size);
  EXPECT_THAT(drop_fragments(volume, std::vector<std::uint64_t>{0, 0, 3, 3}),
              ElementsAre(StructureFragments{2, 2, 2}, StructureFragments{3, 1, 1}));
  const Masks masks = masks_of(volume, 4);
  EXPECT_EQ(masks[0], make_mask(size, [&](auto i, auto j, auto k) { return in(i, j, k) && i < 6; }));
  EXPECT_EQ(masks[2], make_mask(size, [](auto, auto j, auto k) { return j == 0 && k == 0; }));
}

TEST(Fragments, RandomOverlappingMasksMatchFloodFill) {
  std::mt19937 random(7);
  for (std::uint32_t repetition = 0; repetition < repetitions(200); ++repetition) {
    const auto up_to = [&](std::int64_t most) {
      return std::uniform_int_distribution<std::int64_t>(1, most)(random);
    };
    const Index3 size{up_to(9), up_to(8), up_to(7)};
    const double share = 0.1 + 0.6 * static_cast<double>(repetition % 5) / 4;
    std::bernoulli_distribution held(share);
    Masks masks;
    for (int s = 0; s < 3; ++s)
      masks.push_back(make_mask(size, [&](auto, auto, auto) { return held(random); }));
    MembershipVolume volume = memberships_of(masks, size);
    const Masks before = masks;
    const std::vector<std::uint64_t> below{2 + random() % 9, 0, 3};
    std::vector<StructureFragments> expected;
    for (StructureIndex s = 0; s < 3; ++s) {
      const auto sizes = drop_by_flood_fill(masks[s], size, below[s]);
      StructureFragments count{s, sizes.size(), 0};
      for (const std::uint64_t voxels : sizes) count.voxels += voxels;
      if (!sizes.empty()) expected.push_back(count);
    }
    EXPECT_EQ(find_fragments(volume, below), expected);
    EXPECT_EQ(drop_fragments(volume, below), expected);
    // Only voxels of fragments may have gone to the structures around
    const Masks dropped = masks_of(volume, 3);
    for (std::size_t v = 0; v < dropped[0].size(); ++v) {
      const bool was_empty = before[0][v] + before[1][v] + before[2][v] == 0;
      if (!was_empty && masks[0][v] + masks[1][v] + masks[2][v] == 0) continue;
      for (std::size_t s = 0; s < 3; ++s) ASSERT_EQ(dropped[s][v], masks[s][v]);
    }
  }
}

}  // namespace
}  // namespace splatlas
