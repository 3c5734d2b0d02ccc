#include "bench/experiments/stress_inputs.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "tests/support/render.h"

namespace splatlas {
namespace {

constexpr Matrix3 kStraight{1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr double kTurnOffDeg = 1e-6 * 180 / std::numbers::pi;

RenderOptions sized(int width, int height) {
  return {.size = {width, height}};
}

Camera looking(double azimuth_deg, double elevation_deg, double zoom = 1) {
  return {.azimuth_deg = azimuth_deg, .elevation_deg = elevation_deg, .zoom = zoom};
}

std::vector<Camera> usual_views() {
  return {looking(0, 0), looking(33, 21), looking(-160, -70), Camera::of(NamedView::kSuperior)};
}

/// Two overlapping structures, one at a border of the grid.
TestVolume two_structures(const Grid& grid) {
  const auto in_ball = [&](auto i, auto j, auto k) {
    double squares = 0;
    const std::array<double, 3> at{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
    for (std::size_t a = 0; a < 3; ++a)
      squares += std::pow((at[a] + 0.5) / static_cast<double>(grid.size[a]) - 0.5, 2);
    return squares < 0.2;
  };
  const auto in_half = [&](auto i, auto, auto) { return 2 * i < grid.size[0]; };
  return {.grid = grid,
          .structures = {{"ball", make_mask(grid.size, in_ball), {255, 100, 50}},
                         {"half", make_mask(grid.size, in_half), {50, 100, 255}}}};
}

const Grid kSmallGrid{.size = {12, 14, 10}};

constexpr const char* kMixed = "ball:both(opacity=0.5) + half:volume(opacity=0.2)";

StressInput input_of(const TestVolume& volume, std::vector<std::string> selections = {kMixed}) {
  return {make_content(volume), std::move(selections), usual_views(), {sized(33, 29)}};
}

StressInput box(const Index3& size, std::vector<std::string> selections) {
  return input_of(
      {.grid = {.size = size}, .structures = {{"box", make_mask(size, [](auto...) { return true; })}}},
      std::move(selections));
}

/// The two structures in special views.
std::vector<StressInput> seen_from(std::vector<Camera> cameras,
                                   std::vector<RenderOptions> options = {sized(17, 15)}) {
  return {{make_content(two_structures(kSmallGrid)), {kMixed}, std::move(cameras), std::move(options)}};
}

std::vector<std::string> boxes_with(const std::vector<const char*>& opacities) {
  std::vector<std::string> selections;
  for (const char* opacity : opacities) {
    selections.push_back(fmt::format("box:volume(opacity={})", opacity));
    selections.push_back(fmt::format("box:both(opacity={})", opacity));
  }
  return selections;
}

std::vector<StressInput> opacities() {
  return {box({9, 11, 8}, boxes_with({"1e-30", "1e-8", "1e-6", "1e-4", "1e-2", "0.5", "0.9999999", "1"}))};
}

std::vector<StressInput> layers() {
  std::vector<StressInput> inputs{box({5, 5, 4000}, boxes_with({"1e-8", "1e-4", "0.3"}))};
  inputs[0].cameras = {looking(0, 0), Camera::of(NamedView::kSuperior), looking(10, 85, 800)};
  return inputs;
}

std::vector<StressInput> directions() {
  std::vector<Camera> cameras;
  const double diagonal = std::atan(std::sqrt(0.5)) * 180 / std::numbers::pi;
  for (const double azimuth : {0.0, 45.0, 90.0, 135.0, -180.0, -45.0}) {
    for (const double elevation : {0.0, 45.0, diagonal, 90.0, -90.0}) {
      for (const double off : {-kTurnOffDeg, 0.0, kTurnOffDeg}) {
        cameras.push_back(looking(azimuth + off, elevation));
        cameras.push_back(looking(azimuth, elevation + off));
      }
    }
  }
  return seen_from(std::move(cameras), {sized(17, 17)});
}

std::vector<StressInput> grids() {
  std::vector<StressInput> inputs;
  const double c = std::cos(0.4), s = std::sin(0.4);
  const Matrix3 oblique{c, -s, 0, s, c, 0, 0, 0, 1};
  const Matrix3 mirrored{-1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (const Matrix3& direction : {kStraight, oblique, mirrored}) {
    for (const Vec3& spacing :
         {Vec3{1e-6, 1e-6, 1e-6}, Vec3{1e6, 1e6, 1e6}, Vec3{1, 1, 50}, Vec3{50, 1, 1}, Vec3{0.02, 1, 1}}) {
      for (const double away : {0.0, 1e7}) {
        Grid grid = kSmallGrid;
        grid.spacing_mm = spacing;
        grid.direction_lps = direction;
        grid.origin_lps_mm = {away * spacing[0], -away * spacing[1], 0.3 * away * spacing[2]};
        inputs.push_back(input_of(two_structures(grid)));
        inputs.back().cameras.resize(2);
      }
    }
  }
  return inputs;
}

std::vector<StressInput> eyes() {
  std::vector<Camera> cameras;
  for (const double degrees : {1e-3, 1.0, 30.0, 90.0, 150.0, 179.0}) {
    for (const double zoom : {0.01, 1.0, 4.0, 1e3}) {
      for (const Vec3& center : {Vec3{6, 7, 5}, Vec3{0, 0, 0}, Vec3{-0.5, 6.5, 4.5}, Vec3{1e3, 0, 0}}) {
        Camera& camera = cameras.emplace_back(looking(33, 21, zoom));
        camera.field_of_view_deg = degrees;
        camera.center_lps_mm = center;
      }
    }
  }
  return seen_from(std::move(cameras));
}

template <typename T>
StressInput with_values(VoxelType type, const std::vector<T>& pattern) {
  TestVolume volume = two_structures(kSmallGrid);
  std::vector<T> values;
  for (std::int64_t n = 0; n < volume.grid.voxels(); ++n)
    values.push_back(pattern[static_cast<std::size_t>(n * 7 % 31) % pattern.size()]);
  volume.values = make_values(type, values);
  volume.window_high = 100;
  return input_of(volume,
                  {kMixed, "*:volume(profile=hard,low=-10,high=10)", "*:volume(low=-1e30,high=1e30)"});
}

std::vector<StressInput> values() {
  using Float = std::numeric_limits<float>;
  using Double = std::numeric_limits<double>;
  return {
      with_values<float>(VoxelType::kFloat32,
                         {Float::quiet_NaN(), Float::infinity(), -Float::infinity(), Float::denorm_min(),
                          1e38f, -1e38f, 0, -0.0f, Float::min(), 50}),
      with_values<double>(VoxelType::kFloat64, {Double::quiet_NaN(), Double::infinity(), -Double::infinity(),
                                                Double::denorm_min(), 1e300, -1e300, 0, 50}),
      with_values<float>(VoxelType::kFloat32, {Float::quiet_NaN()}),
      with_values<float>(VoxelType::kFloat32, {Float::infinity()}),
      with_values<std::int16_t>(VoxelType::kInt16, {-32768, 32767, 0, -1, 50}),
      with_values<std::uint16_t>(VoxelType::kUInt16, {0, 65535, 1, 50}),
  };
}

std::vector<StressInput> broken_views() {
  std::vector<Camera> cameras;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double broken : {kNan, kInfinity, -kInfinity, 1e308, 1e-308, 0.0, -1.0}) {
    cameras.insert(cameras.end(), {{.azimuth_deg = broken},
                                   {.elevation_deg = broken},
                                   {.zoom = broken},
                                   {.center_lps_mm = Vec3{broken, 0, 0}},
                                   {.field_of_view_deg = broken}});
  }
  return seen_from(std::move(cameras));
}

std::vector<StressInput> shapes() {
  std::vector<StressInput> inputs;
  for (const Index3& size : {Index3{1, 1, 1}, Index3{1, 1, 40}, Index3{2, 2, 2}, Index3{40, 1, 40}}) {
    inputs.push_back(box(size, {"box:both(opacity=0.7)", "box:surface(opacity=0.5)", "box:volume - box"}));
  }
  StressInput row = box({65537, 1, 1}, {"box:volume(opacity=0.5)"});
  row.cameras = {looking(0, 0), looking(90, 0), looking(20, 10, 5e3)};
  inputs.push_back(std::move(row));
  return inputs;
}

std::vector<StressInput> labels() {
  std::vector<StressInput> inputs;
  std::mt19937 random(1);
  const auto add = [&](const auto& holds) {
    const Index3 size{19, 18, 17};
    const auto others = [&](auto i, auto j, auto k) { return !holds(i, j, k); };
    const TestVolume volume{.grid = {.size = size},
                            .structures = {{"even", make_mask(size, holds), {255, 100, 50}},
                                           {"odd", make_mask(size, others), {50, 100, 255}}}};
    inputs.push_back(input_of(volume, {"even:both(opacity=0.4)", "*:both(opacity=0.4)", "even - *"}));
  };
  add([](auto i, auto j, auto k) { return (i + j + k) % 2 == 0; });
  add([](auto i, auto, auto) { return i % 2 == 0; });
  add([&](auto, auto, auto) { return random() % 2 == 0; });
  return inputs;
}

/// Degenerate triangles and slivers, in every plane of voxels.
std::vector<StressInput> triangles() {
  StressInput input =
      input_of(two_structures(kSmallGrid), {"ball:surface(opacity=0.5)", kMixed, "*:both(opacity=0.3)"});
  SurfaceMesh& mesh = input.content.surfaces[0];
  const auto vertices = static_cast<std::uint32_t>(mesh.positions_ijk.size());
  for (std::size_t n = 0; n + 2 < mesh.triangles.size(); n += 7) {
    auto& triangle = mesh.triangles[n];
    if (n % 2 == 0) triangle[1] = triangle[0];                   // two equal vertices
    if (n % 3 == 0) triangle[2] = triangle[1];                   // three equal vertices
    if (n % 5 == 0) triangle = {0, vertices / 2, vertices - 1};  // across many slices
  }
  for (std::size_t n = 0; n < mesh.positions_ijk.size(); n += 3) {
    for (auto& place : mesh.positions_ijk[n]) place = std::round(place);  // in planes of voxel centres
  }
  return {input};
}

std::vector<StressInput> zooms() {
  std::vector<Camera> cameras;
  for (const double zoom : {1e-6, 1e-3, 0.05, 30.0, 1e3, 1e6}) cameras.push_back(looking(33, 21, zoom));
  return seen_from(std::move(cameras), {sized(17, 15), sized(1, 1), sized(1, 400), sized(400, 1)});
}

/// Rows of 1 to 17 voxels: remainders of vectors.
std::vector<StressInput> tails() {
  std::vector<StressInput> inputs;
  for (std::int64_t width = 1; width <= 17; ++width) {
    inputs.push_back(box({width, 3, 4}, {"box:both(opacity=0.6)"}));
    inputs.back().options = {sized(static_cast<int>(width), 7)};
    inputs.back().cameras.resize(2);
  }
  return inputs;
}

std::vector<StressInput> curves() {
  TestVolume volume = two_structures(kSmallGrid);
  std::vector<std::uint8_t> values;
  for (std::int64_t n = 0; n < volume.grid.voxels(); ++n)
    values.push_back(static_cast<std::uint8_t>(n * 37 % 256));
  volume.values = make_values(VoxelType::kUInt8, values);
  volume.window_low = 50;
  volume.window_high = 50;  // an empty window
  return {input_of(volume, {kMixed, "*:volume(curve=7:0.5)", "*:volume(curve=0:0/1e-9:0.9999)",
                            "*:volume(curve=9:0:0/100:0.2:1/100.000001:0.9:0/200:0)",
                            "*:volume(profile=hard)", "*:volume(low=3,high=3.0000000001)"})};
}

}  // namespace

std::vector<StressKind> stress_kinds() {
  return {{"opacities from 1e-30 to 1", opacities},
          {"4000 layers", layers},
          {"axis switches, 1e-6 rad off and exact", directions},
          {"spacings 1e-6 to 1e6, 1:1:50, oblique, mirrored, 1e7 away", grids},
          {"eyes inside, fields of view 0.001 to 179 degrees", eyes},
          {"NaN, infinities, denormals, ends of types", values},
          {"views that are not finite", broken_views},
          {"1 voxel, 1 x 1 x N, 65537 in a row, nothing", shapes},
          {"checkerboard, comb, random labels", labels},
          {"degenerate triangles, on sheets, across many", triangles},
          {"zooms 1e-6 to 1e6, pictures of 1 pixel", zooms},
          {"rows of 1 to 17 voxels", tails},
          {"steps, points and empty windows as transfer functions", curves}};
}

}  // namespace splatlas
