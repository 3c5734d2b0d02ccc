#include "player/render/frame/draft_pace.h"

#include <tuple>

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

TEST(DraftPace, RaysHaveNoSheetPixelsToLose) {
  DraftPace pace(true);
  EXPECT_EQ(pace.next(2, true).level, 0);
  pace.took(40, kBudget);
  EXPECT_EQ(pace.next(2, true).level, 1);
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

constexpr auto kReady = [](int /*level*/) { return true; };

TEST(SurfacePace, SilhouettesAreExactWithinAPixelUnlessDraftsAreLate) {
  for (const auto& [voxel_pixels, fine, coarse] : {std::tuple(0.01, 5, 5),
                                                   {0.3, 3, 4},
                                                   {0.6, 2, 3},
                                                   {1.2, 1, 2},
                                                   {1.6, 0, 1},
                                                   {3.0, 0, 1},
                                                   {3.1, 0, 0}}) {
    SurfacePace pace;
    EXPECT_EQ(pace.next(voxel_pixels, kReady), fine) << voxel_pixels;
    pace.took(1e9, kBudget);
    EXPECT_EQ(pace.next(voxel_pixels, kReady), coarse) << voxel_pixels;
    pace.took(0, kBudget);
    EXPECT_EQ(pace.next(voxel_pixels, kReady), std::max(coarse - 1, fine)) << voxel_pixels;
  }
}

TEST(SurfacePace, CoarserSurfacesStandInForThoseThatTakeLongToDerive) {
  const auto from = [](int ready) { return [ready](int level) { return level >= ready; }; };
  SurfacePace pace;
  EXPECT_EQ(pace.next(2, from(1)), 1);
  pace.took(20, kBudget);
  EXPECT_EQ(pace.next(2, kReady), 0);
  EXPECT_EQ(pace.next(9, from(1)), 0) << "too wide";
  EXPECT_EQ(pace.next(0.5, from(1)), 2);
  EXPECT_EQ(pace.next(0.5, from(4)), 4);
  EXPECT_EQ(pace.next(0.5, from(9)), 4) << "twelve pixels at most";
}

}  // namespace
}  // namespace splatlas
