// Invalid files: grid, types, display.
#include <limits>

#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr BadFile kSizes[] = {
    {"x of no voxels", [](RawAtlas& a) { a.directory.source_grid.size[0] = 0; },
     "F: invalid: source grid: size 0x5x4 voxels: each axis must have 1 to 16777216"},
    {"y of no voxels", [](RawAtlas& a) { a.directory.source_grid.size[1] = 0; },
     "F: invalid: source grid: size 10x0x4 voxels: each axis must have 1 to 16777216"},
    {"z of no voxels", [](RawAtlas& a) { a.directory.source_grid.size[2] = 0; },
     "F: invalid: source grid: size 10x5x0 voxels: each axis must have 1 to 16777216"},
    {"x negative", [](RawAtlas& a) { a.directory.source_grid.size[0] = -10; },
     "F: invalid: source grid: size -10x5x4 voxels: each axis must have 1 to 16777216"},
    {"x and y negative",
     [](RawAtlas& a) {
       a.directory.source_grid.size = {-10, -5, 4};
     },
     "F: invalid: source grid: size -10x-5x4 voxels: each axis must have 1 to 16777216"},
    {"z the minimum",
     [](RawAtlas& a) { a.directory.source_grid.size[2] = std::numeric_limits<std::int64_t>::min(); },
     "F: invalid: source grid: size 10x5x-9223372036854775808 voxels: each axis must have 1 to 16777216"},
    {"x the largest number",
     [](RawAtlas& a) { a.directory.source_grid.size[0] = std::numeric_limits<std::int64_t>::max(); },
     "F: invalid: source grid: size 9223372036854775807x5x4 voxels: each axis must have 1 to 16777216"},
    {"y above the limit", [](RawAtlas& a) { a.directory.source_grid.size[1] = (1 << 24) + 1; },
     "F: invalid: source grid: size 10x16777217x4 voxels: each axis must have 1 to 16777216"},
    {"a product above the limit",
     [](RawAtlas& a) {
       a.directory.source_grid.size = {1 << 14, 1 << 14, (1 << 12) + 1};
     },
     "F: invalid: source grid: size 16384x16384x4097 voxels is above the limit of 1099511627776 voxels"},
    {"a product that wraps to 0",
     [](RawAtlas& a) {
       a.directory.source_grid.size = {1 << 24, 1 << 24, 1 << 16};
     },
     "F: invalid: source grid: size 16777216x16777216x65536 voxels is above the limit of 1099511627776 "
     "voxels"},
    {"a product that wraps to the same",
     [](RawAtlas& a) {
       a.directory.source_grid.size = {1 << 24, 1 << 24, 1 << 24};
     },
     "F: invalid: source grid: size 16777216x16777216x16777216 voxels is above the limit of 1099511627776 "
     "voxels"},
    {"one voxel along x more", [](RawAtlas& a) { a.directory.source_grid.size[0] = 11; },
     "F: invalid: classes have 200 voxels, the grid has 220"},
    {"one voxel along x less", [](RawAtlas& a) { a.directory.source_grid.size[0] = 9; },
     "F: invalid: box of class 0 does not fit its 131 voxels in the grid"},
    {"x and y exchanged",
     [](RawAtlas& a) {
       a.directory.source_grid.size = {5, 10, 4};
     },
     "F: invalid: box of class 0 does not fit its 131 voxels in the grid"},
    {"the maximum number of voxels",
     [](RawAtlas& a) {
       a.directory.source_grid.size = {1 << 14, 1 << 13, 1 << 13};
     },
     "F: invalid: classes have 200 voxels, the grid has 1099511627776"},
};

constexpr BadFile kPlaces[] = {
    {"spacing of x 0", [](RawAtlas& a) { a.directory.source_grid.spacing_mm[0] = 0; },
     "F: invalid: source grid: spacing 0 mm must be positive and finite"},
    {"spacing of y negative", [](RawAtlas& a) { a.directory.source_grid.spacing_mm[1] = -1.5; },
     "F: invalid: source grid: spacing -1.5 mm must be positive and finite"},
    {"spacing of z no number", [](RawAtlas& a) { a.directory.source_grid.spacing_mm[2] = kNan; },
     "F: invalid: source grid: spacing nan mm must be positive and finite"},
    {"spacing of x infinite", [](RawAtlas& a) { a.directory.source_grid.spacing_mm[0] = kInf; },
     "F: invalid: source grid: spacing inf mm must be positive and finite"},
    {"spacing of y negative infinite", [](RawAtlas& a) { a.directory.source_grid.spacing_mm[1] = -kInf; },
     "F: invalid: source grid: spacing -inf mm must be positive and finite"},
    {"origin of x no number", [](RawAtlas& a) { a.directory.source_grid.origin_lps_mm[0] = kNan; },
     "F: invalid: source grid: the origin is not finite"},
    {"origin of y infinite", [](RawAtlas& a) { a.directory.source_grid.origin_lps_mm[1] = kInf; },
     "F: invalid: source grid: the origin is not finite"},
    {"origin of z negative infinite", [](RawAtlas& a) { a.directory.source_grid.origin_lps_mm[2] = -kInf; },
     "F: invalid: source grid: the origin is not finite"},
    {"spacing of x too small", [](RawAtlas& a) { a.directory.source_grid.spacing_mm[0] = 1e-10; },
     "F: invalid: source grid: spacing 1e-10 mm must be from 1e-09 to 1000000000 mm"},
    {"spacing of z too large", [](RawAtlas& a) { a.directory.source_grid.spacing_mm[2] = 2e9; },
     "F: invalid: source grid: spacing 2000000000 mm must be from 1e-09 to 1000000000 mm"},
    {"origin too far away",
     [](RawAtlas& a) {
       a.directory.source_grid.origin_lps_mm = {0, -1.7e308, 0};
     },
     "F: invalid: source grid: the origin (0, -1.7e+308, 0 mm) must be within 1000000000000000 mm"},
    {"an origin that is too far away when axes are reversed",
     [](RawAtlas& a) {
       a.directory.source_grid.origin_lps_mm = {1e15, 0, 0};
       a.directory.source_grid.spacing_mm[0] = 1e9;
       a.directory.source_to_storage.flipped[0] = 1;
     },
     "F: invalid: storage grid: the origin (1000009000000000, 0, 0 mm) must be within 1000000000000000 mm"},
    {"direction too long", [](RawAtlas& a) { a.directory.source_grid.direction_lps[0] = 1e4; },
     "F: invalid: source grid: axis 0 of the direction has length 10000, expected 1"},
    {"direction too short", [](RawAtlas& a) { a.directory.source_grid.direction_lps[8] = 1e-4; },
     "F: invalid: source grid: axis 2 of the direction has length 0.0001, expected 1"},
    {"direction with no number", [](RawAtlas& a) { a.directory.source_grid.direction_lps[4] = kNan; },
     "F: invalid: source grid: the direction is not finite"},
    {"direction infinite", [](RawAtlas& a) { a.directory.source_grid.direction_lps[8] = kInf; },
     "F: invalid: source grid: the direction is not finite"},
    {"direction of zeros", [](RawAtlas& a) { a.directory.source_grid.direction_lps = {}; },
     "F: invalid: source grid: the direction [0 0 0 0 0 0 0 0 0] is singular: its axes must span space"},
    {"an axis without a direction", [](RawAtlas& a) { a.directory.source_grid.direction_lps[0] = 0; },
     "F: invalid: source grid: the direction [0 0 0 0 1 0 0 0 1] is singular: its axes must span space"},
    {"two axes with one direction",
     [](RawAtlas& a) { a.directory.source_grid.direction_lps = {1, 1, 0, 0, 0, 0, 0, 0, 1}; },
     "F: invalid: source grid: the direction [1 1 0 0 0 0 0 0 1] is singular: its axes must span space"},
    {"two axes with opposite directions",
     [](RawAtlas& a) { a.directory.source_grid.direction_lps = {1, -1, 0, 0, 0, 0, 0, 0, 1}; },
     "F: invalid: source grid: the direction [1 -1 0 0 0 0 0 0 1] is singular: its axes must span space"},
    {"axes in one plane",
     [](RawAtlas& a) { a.directory.source_grid.direction_lps = {1, 0, 1, 0, 1, 1, 0, 0, 0}; },
     "F: invalid: source grid: the direction [1 0 1 0 1 1 0 0 0] is singular: its axes must span space"},
};

constexpr BadFile kOrdersAndTypes[] = {
    {"an axis taken twice",
     [](RawAtlas& a) {
       a.directory.source_to_storage.from = {0, 1, 1};
     },
     "F: invalid: axis order is not a permutation"},
    {"one axis alone",
     [](RawAtlas& a) {
       a.directory.source_to_storage.from = {2, 2, 2};
     },
     "F: invalid: axis order is not a permutation"},
    {"a fourth axis",
     [](RawAtlas& a) {
       a.directory.source_to_storage.from = {0, 1, 3};
     },
     "F: invalid: axis order is not a permutation"},
    {"axis 255",
     [](RawAtlas& a) {
       a.directory.source_to_storage.from = {255, 1, 2};
     },
     "F: invalid: axis order is not a permutation"},
    {"an axis reversed twice", [](RawAtlas& a) { a.directory.source_to_storage.flipped[1] = 2; },
     "F: invalid: an axis is reversed by 2"},
    {"an axis reversed 255 times", [](RawAtlas& a) { a.directory.source_to_storage.flipped[2] = 255; },
     "F: invalid: an axis is reversed by 255"},
    {"axes in another order",
     [](RawAtlas& a) {
       a.directory.source_to_storage.from = {1, 0, 2};
     },
     "F: invalid: box of class 0 does not fit its 131 voxels in the grid"},
    {"value type 9", [](RawAtlas& a) { a.directory.value_type = 9; }, "F: invalid: unknown voxel type 9"},
    {"value type 255", [](RawAtlas& a) { a.directory.value_type = 255; },
     "F: invalid: unknown voxel type 255"},
    {"no value type", [](RawAtlas& a) { a.directory.value_type = 0; },
     "F: invalid: section values has 2 chunks, its streams of 0 bytes need 0"},
    {"values of two bytes", [](RawAtlas& a) { a.directory.value_type = 3; },
     "F: damaged: wrong frame length (expected 458 bytes) of values of classes 0 to 2"},
    {"values of four bytes", [](RawAtlas& a) { a.directory.value_type = 5; },
     "F: damaged: wrong frame length (expected 524 bytes) of values of class 0"},
    {"values of eight bytes", [](RawAtlas& a) { a.directory.value_type = 8; },
     "F: invalid: section values has 2 chunks, its streams of 1600 bytes need more"},
    {"label type 9", [](RawAtlas& a) { a.directory.label_type = 9; }, "F: invalid: unknown voxel type 9"},
    {"label type 255", [](RawAtlas& a) { a.directory.label_type = 255; },
     "F: invalid: unknown voxel type 255"},
};

constexpr BadFile kDisplays[] = {
    {"window from no number", [](RawAtlas& a) { a.directory.display.window_low = kNan; },
     "F: invalid: display: window nan to 240, ball at 4, 3, 3 of radius 9"},
    {"window from infinity", [](RawAtlas& a) { a.directory.display.window_low = -kInf; },
     "F: invalid: display: window -inf to 240, ball at 4, 3, 3 of radius 9"},
    {"window to no number", [](RawAtlas& a) { a.directory.display.window_high = kNan; },
     "F: invalid: display: window 10 to nan, ball at 4, 3, 3 of radius 9"},
    {"window to infinity", [](RawAtlas& a) { a.directory.display.window_high = kInf; },
     "F: invalid: display: window 10 to inf, ball at 4, 3, 3 of radius 9"},
    {"centre's x no number", [](RawAtlas& a) { a.directory.display.center_lps_mm[0] = kNan; },
     "F: invalid: display: window 10 to 240, ball at nan, 3, 3 of radius 9"},
    {"centre's y infinite", [](RawAtlas& a) { a.directory.display.center_lps_mm[1] = kInf; },
     "F: invalid: display: window 10 to 240, ball at 4, inf, 3 of radius 9"},
    {"centre's z no number", [](RawAtlas& a) { a.directory.display.center_lps_mm[2] = kNan; },
     "F: invalid: display: window 10 to 240, ball at 4, 3, nan of radius 9"},
    {"centre's x too far away", [](RawAtlas& a) { a.directory.display.center_lps_mm[0] = 1.7e308; },
     "F: invalid: display: window 10 to 240, ball at 1.7e+308, 3, 3 of radius 9"},
    {"radius too large", [](RawAtlas& a) { a.directory.display.radius_mm = 1.7e308; },
     "F: invalid: display: window 10 to 240, ball at 4, 3, 3 of radius 1.7e+308"},
    {"radius negative", [](RawAtlas& a) { a.directory.display.radius_mm = -1; },
     "F: invalid: display: window 10 to 240, ball at 4, 3, 3 of radius -1"},
    {"radius no number", [](RawAtlas& a) { a.directory.display.radius_mm = kNan; },
     "F: invalid: display: window 10 to 240, ball at 4, 3, 3 of radius nan"},
    {"radius infinite", [](RawAtlas& a) { a.directory.display.radius_mm = kInf; },
     "F: invalid: display: window 10 to 240, ball at 4, 3, 3 of radius inf"},
    {"a ball of nothing, which may be", [](RawAtlas& a) { a.directory.display.radius_mm = 0; }, ""},
    {"a window the wrong way round, which may be", [](RawAtlas& a) { a.directory.display.window_low = 999; },
     ""},
};

TEST(BadFiles, WithABadSize) {
  expect_refused(kSizes);
}
TEST(BadFiles, WithABadPlace) {
  expect_refused(kPlaces);
}
TEST(BadFiles, WithABadOrderOrType) {
  expect_refused(kOrdersAndTypes);
}
TEST(BadFiles, WithABadDisplay) {
  expect_refused(kDisplays);
}

}  // namespace
}  // namespace splatlas
