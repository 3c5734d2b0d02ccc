// Invalid files: grid, types, display.
#include <limits>

#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr auto kMinimum = std::numeric_limits<std::int64_t>::min();

/// A size of the source grid.
struct BadSize {
  const char* what;
  std::array<std::int64_t, 3> size;
  const char* message = "";
};

constexpr BadSize kSizes[] = {
    {"x of no voxels", {0, 5, 4}, "0x5x4"},
    {"x negative", {-10, 5, 4}, "-10x5x4"},
    {"z the minimum", {10, 5, kMinimum}, "10x5x-9223372036854775808"},
    {"y above the limit", {10, (1 << 24) + 1, 4}, "10x16777217x4"},
};

constexpr BadSize kProducts[] = {
    {"above the limit", {1 << 14, 1 << 14, (1 << 12) + 1}, "16384x16384x4097"},
    {"that wraps to 0", {1 << 24, 1 << 24, 1 << 16}, "16777216x16777216x65536"},
};

constexpr BadSize kOtherSizes[] = {
    {"one voxel along x more", {11, 5, 4}, "classes have 200 voxels, the grid has 220"},
    {"the maximum number of voxels",
     {1 << 14, 1 << 13, 1 << 13},
     "classes have 200 voxels, the grid has 1099511627776"},
};

constexpr BadPart<RawGrid> kSpacings[] = {
    {[](auto& g) { g.spacing_mm[0] = 0; }, "0 mm must be positive and finite"},
    {[](auto& g) { g.spacing_mm[1] = -1.5; }, "-1.5 mm must be positive and finite"},
    {[](auto& g) { g.spacing_mm[2] = kNan; }, "nan mm must be positive and finite"},
    {[](auto& g) { g.spacing_mm[0] = kInf; }, "inf mm must be positive and finite"},
    {[](auto& g) { g.spacing_mm[0] = 1e-10; }, "1e-10 mm must be from 1e-09 to 1000000000 mm"},
    {[](auto& g) { g.spacing_mm[2] = 2e9; }, "2000000000 mm must be from 1e-09 to 1000000000 mm"},
};

constexpr BadPart<RawGrid> kPlaces[] = {
    {[](auto& g) { g.origin_lps_mm[0] = kNan; }, "the origin is not finite"},
    {[](auto& g) { g.origin_lps_mm[1] = -1.7e308; },
     "the origin (0, -1.7e+308, 0 mm) must be within 1000000000000000 mm"},
    {[](auto& g) { g.direction_lps[0] = 1e4; }, "axis 0 of the direction has length 10000, expected 1"},
    {[](auto& g) { g.direction_lps[8] = 1e-4; }, "axis 2 of the direction has length 0.0001, expected 1"},
    {[](auto& g) { g.direction_lps[4] = kNan; }, "the direction is not finite"},
};

constexpr BadPart<RawGrid> kDirections[] = {
    {[](auto& g) { g.direction_lps = {}; }, "0 0 0 0 0 0 0 0 0"},
    {[](auto& g) { g.direction_lps = {1, 1, 0, 0, 0, 0, 0, 0, 1}; }, "1 1 0 0 0 0 0 0 1"},
    {[](auto& g) { g.direction_lps = {1, 1, 0, 0, 1e-8, 0, 0, 0, 1}; }, "1 1 0 0 1e-08 0 0 0 1"},
};

constexpr BadPart<RawAxisOrder> kOrders[] = {
    {[](auto& o) { o.from[2] = 1; }, "axis order is not a permutation"},
    {[](auto& o) { o.from[2] = 3; }, "axis order is not a permutation"},
    {[](auto& o) { o.flipped[1] = 2; }, "an axis is reversed by 2"},
    {[](auto& o) { std::swap(o.from[0], o.from[1]); },
     "box of class 0 does not fit its 131 voxels in the grid"},
};

constexpr BadPart<RawDirectory> kTypes[] = {
    {[](auto& d) { d.value_type = 9; }, "invalid: unknown voxel type 9"},
    {[](auto& d) { d.value_type = 0; },
     "invalid: section values has 2 chunks, its streams of 0 bytes need 0"},
    {[](auto& d) { d.value_type = 3; },
     "damaged: wrong frame length (expected 458 bytes) of values of classes 0 to 2"},
    {[](auto& d) { d.value_type = 8; },
     "invalid: section values has 2 chunks, its streams of 1600 bytes need more"},
    {[](auto& d) { d.label_type = 9; }, "invalid: unknown voxel type 9"},
    {[](auto& d) {
       d.source_grid.origin_lps_mm[0] = 1e15;
       d.source_grid.spacing_mm[0] = 1e9;
       d.source_to_storage.flipped[0] = 1;
     },
     "invalid: storage grid: the origin (1000009000000000, 0, 0 mm) must be within 1000000000000000 mm"},
};

constexpr BadPart<RawDisplay> kWindows[] = {
    {[](auto& d) { d.window_low = kNan; }, "nan to 240"},
    {[](auto& d) { d.window_high = kInf; }, "10 to inf"},
};

constexpr BadPart<RawDisplay> kBalls[] = {
    {[](auto& d) { d.center_lps_mm[0] = kNan; }, "nan, 3, 3 of radius 9"},
    {[](auto& d) { d.center_lps_mm[0] = 1.7e308; }, "1.7e+308, 3, 3 of radius 9"},
    {[](auto& d) { d.radius_mm = 1.7e308; }, "4, 3, 3 of radius 1.7e+308"},
    {[](auto& d) { d.radius_mm = -1; }, "4, 3, 3 of radius -1"},
    {[](auto& d) { d.radius_mm = kNan; }, "4, 3, 3 of radius nan"},
};

constexpr BadFile<RawDisplay> kValidDisplays[] = {
    {"a ball of nothing", [](auto& d) { d.radius_mm = 0; }},
    {"a window the wrong way round", [](auto& d) { d.window_low = 999; }},
};

TEST(BadFiles, WithABadSize) {
  const auto set_size = [](RawAtlas& a, const BadSize& row) { a.directory.source_grid.size = row.size; };
  expect_faults(kSizes, "F: invalid: source grid: size {} voxels: each axis must have 1 to 16777216",
                set_size);
  expect_faults(kProducts,
                "F: invalid: source grid: size {} voxels is above the limit of 1099511627776 voxels",
                set_size);
  expect_faults(kOtherSizes, "F: invalid: {}", set_size);
}

TEST(BadFiles, WithABadPlace) {
  const auto in_grid = in_part(&RawDirectory::source_grid);
  expect_faults(kSpacings, "F: invalid: source grid: spacing {}", in_grid);
  expect_faults(kPlaces, "F: invalid: source grid: {}", in_grid);
  expect_faults(kDirections,
                "F: invalid: source grid: the direction [{}] is singular: its axes must span space", in_grid);
}

TEST(BadFiles, WithABadOrderOrType) {
  expect_faults(kOrders, "F: invalid: {}", in_part(&RawDirectory::source_to_storage));
  expect_faults(kTypes, "F: {}", in_directory);
}

TEST(BadFiles, WithABadDisplay) {
  const auto in_display = in_part(&RawDirectory::display);
  expect_faults(kWindows, "F: invalid: display: window {}, ball at 4, 3, 3 of radius 9", in_display);
  expect_faults(kBalls, "F: invalid: display: window 10 to 240, ball at {}", in_display);
  expect_faults(kValidDisplays, "", in_display);
}

}  // namespace
}  // namespace splatlas
