#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "player/render/light/voxel_light.h"
#include "player/render/sheets/spans/span_model.h"
#include "tests/support/kernel_targets.h"

namespace splatlas {
namespace {

/// Rows of gradients and lit voxels, with the padding of kernels.
struct Rows {
  std::array<std::vector<float>, 3> direction;
  std::vector<float> coherence, reach;
  std::vector<PackedNormal> normals;
  std::vector<std::uint16_t> lit;

  explicit Rows(std::size_t count) {
    for (std::vector<float>* row : {&direction[0], &direction[1], &direction[2], &coherence, &reach})
      row->resize(count + kLightPadding);
    normals.resize(count + kLightPadding);
    lit.resize(normals.size());
  }
  GradientRow gradients() {
    return {{direction[0].data(), direction[1].data(), direction[2].data()}, coherence.data(), reach.data()};
  }
  LightRow lights() { return {normals.data(), lit.data()}; }
};

double degrees_apart(PackedNormal packed, const std::array<float, 3>& v) {
  const std::array<float, 3> n = unpack_normal(packed);
  double dot = 0, squares = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    dot += static_cast<double>(n[a]) * static_cast<double>(v[a]);
    squares += static_cast<double>(v[a]) * static_cast<double>(v[a]);
  }
  return std::acos(std::min(dot / std::sqrt(squares), 1.0)) * 180 / std::numbers::pi;
}

class LightKernelsOf : public testing::TestWithParam<std::int64_t> {
 protected:
  DispatchTo only_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Every, LightKernelsOf, testing::ValuesIn(kernel_targets()),
                         [](const auto& info) { return std::string(hwy::TargetName(info.param)); });

TEST_P(LightKernelsOf, PackGradientsTowardsLowExtinctions) {
  std::mt19937 random(1);
  std::normal_distribution<float> component;
  constexpr std::size_t kCount = 20000;
  Rows rows(kCount);
  for (std::vector<float>& of_axis : rows.direction) {
    for (float& value : of_axis) value = 7 * component(random);
  }
  std::ranges::fill(rows.coherence, 1.0f);
  rows.direction[0][0] = std::numeric_limits<float>::quiet_NaN();  // any code
  rows.direction[1][1] = std::numeric_limits<float>::infinity();
  rows.direction[0][2] = rows.direction[1][2] = 0;
  rows.direction[2][2] = 1e-20f;
  const std::vector<float> below(kCount + kLightPadding, 0.25f), above(kCount + kLightPadding, 0.5f);
  light_kernels().light(below.data(), above.data(), kCount, rows.gradients(), rows.lights());
  double largest = 0;
  for (std::size_t n = 2; n < kCount; ++n) {
    ASSERT_EQ(rows.lit[n], 65535);
    largest = std::max(largest, degrees_apart(rows.normals[n], {-rows.direction[0][n], -rows.direction[1][n],
                                                                -rows.direction[2][n]}));
  }
  EXPECT_LT(largest, 0.95);  // each component of the map is rounded by itself
  EXPECT_GT(largest, 0.8);
}

TEST_P(LightKernelsOf, KeepTheNormalsOfBordersInNoise) {
  constexpr std::size_t kCodes = 65536;
  Rows rows(kCodes);
  for (std::vector<float>& of_axis : rows.direction) std::ranges::fill(of_axis, 1.0f);
  std::vector<PackedNormal> labels(kCodes + kLightPadding);
  for (std::size_t n = 0; n < kCodes; ++n) labels[n] = static_cast<PackedNormal>(n);
  rows.normals = labels;
  std::ranges::fill(rows.lit, VoxelLight::kAllLit);
  const std::vector<float> none(kCodes + kLightPadding);
  light_kernels().light(none.data(), none.data(), kCodes, rows.gradients(), rows.lights());
  for (std::size_t n = 0; n < kCodes; ++n) {
    const std::array<float, 3> is = unpack_normal(rows.normals[n]), was = unpack_normal(labels[n]);
    for (std::size_t a = 0; a < 3; ++a) ASSERT_NEAR(is[a], was[a], 1e-6) << n;
  }
}

TEST_P(LightKernelsOf, EmitTheLitPartOfLitVoxelsAlone) {
  std::vector<float> factors(65536);
  for (std::size_t code = 0; code < factors.size(); ++code) factors[code] = static_cast<float>(code) / 65536;
  std::vector<BlockLights> lights(3);  // of every other block of 6
  for (std::uint32_t n = 0; n < 48; ++n) {
    lights[n / 16].block = 10 + n / 16 * 2;
    lights[n / 16].lights[n % 16] = {static_cast<PackedNormal>(n * 1361),
                                     static_cast<std::uint16_t>(n % 3 * 30000)};
  }
  for (const int emissions : {1, 3}) {
    OpticalBuffer unlit, lit;
    const std::size_t planes = 1 + static_cast<std::size_t>(emissions), floats = 6 * 16 * planes;
    for (std::size_t n = 0; n < floats; ++n) *unlit.append(1) = 0.125f * static_cast<float>(n);
    light_kernels().emit({10, 6, emissions, unlit.data(), lights}, factors.data(), lit.append(floats));
    for (std::size_t n = 0; n < floats; ++n) {
      const std::size_t block = n / 16 / planes;
      const VoxelLight light = block % 2 == 0 ? lights[block / 2].lights[n % 16] : VoxelLight{};
      const float share = n / 16 % planes == 0 ? 0 : static_cast<float>(light.lit) / 65535;
      EXPECT_EQ(lit.data()[n], unlit.data()[n] * (1 + share * (factors[light.normal] - 1)));
    }
  }
}

/// Extinctions of whole grey values, linear in between and constant beyond.
TEST_P(LightKernelsOf, FindExtinctionsAroundGreyValues) {
  const TransferShape shape{{{-3, 0.0, 1}, {4, 0.7, 1}}};
  const TransferTable table(shape, VoxelType::kInt8);
  const std::size_t count = 1000;
  std::vector<float> greys(count + kLightPadding), reach(greys.size()), below(greys.size()),
      above(greys.size());
  for (std::size_t n = 0; n < count; ++n) {
    greys[n] = static_cast<float>(n % 41) / 2 - 10;
    reach[n] = static_cast<float>(n % 7) * 0.75f;
  }
  greys[999] = 1e30f;
  light_kernels().extinctions(table.view(), greys.data(), reach.data(), count, below.data(), above.data());
  const auto expected = [](float grey) { return 0.1f * std::clamp(grey + 3, 0.0f, 7.0f); };
  for (std::size_t n = 0; n < count; ++n) {
    ASSERT_NEAR(below[n], expected(greys[n] - reach[n]), 1e-6) << n;
    ASSERT_NEAR(above[n], expected(greys[n] + reach[n]), 1e-6) << n;
  }
}

}  // namespace
}  // namespace splatlas
