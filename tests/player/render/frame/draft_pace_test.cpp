#include "player/render/frame/draft_pace.h"

#include <gtest/gtest.h>

namespace splatlas {
namespace {

constexpr double kBudget = 30;

TEST(DraftPace, LateDraftsBecomeCoarserAndQuickOnesFiner) {
  DraftPace pace;
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{0, 2}));
  pace.took(40, kBudget);
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{0, 1}));
  pace.took(29, kBudget);
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{0, 1})) << "a finer draft would be late";
  pace.took(150, kBudget);
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{1, 1}));
  pace.took(3, kBudget);
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{1, 1})) << "the voxels may take 36 ms";
  pace.took(2, kBudget);
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{0, 1}));
  pace.took(7, kBudget);
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{0, 2}));
}

TEST(DraftPace, MeansAreAtMostSixPixelsWide) {
  for (const auto& [voxel_pixels, level] : {std::pair(0.5, 3), {0.75, 3}, {1.0, 2}, {3.0, 1}, {3.1, 0}}) {
    DraftPace pace;
    EXPECT_EQ(pace.next(voxel_pixels, true).level, 0);
    pace.took(1e9, kBudget);
    EXPECT_EQ(pace.next(voxel_pixels, true).level, level) << voxel_pixels;
  }
}

TEST(DraftPace, MeansStandInForVoxelsThatTakeLongToPrepare) {
  DraftPace pace;
  EXPECT_EQ(pace.next(2, false), (VolumeDetail{1, 1}));
  EXPECT_EQ(pace.next(2, true), (VolumeDetail{0, 2}));
  EXPECT_EQ(pace.next(9, false), (VolumeDetail{0, 2})) << "too wide";
}

}  // namespace
}  // namespace splatlas
