#include "format/codec/value_filter.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace splatlas {
namespace {

/// Lines of neighbours, padded to whole vectors, with some voxels missing.
template <typename Lane>
struct Lines {
  static constexpr std::size_t kCount = 150;
  std::array<std::vector<Lane>, kNeighbours.size()> values;
  std::array<std::vector<std::uint8_t>, kErrorNeighbours> errors;
  FilterInput<Lane> input{};

  explicit Lines(std::mt19937& random) {
    for (std::size_t q = 0; q < values.size(); ++q) {
      for (std::size_t n = 0; n < kCount + kFilterPadding; ++n)
        values[q].push_back(
            static_cast<Lane>(random() % 3 == 0 ? -1 : static_cast<Lane>(random() % highest)));
      input.values[q] = values[q].data();
      input.weights[q] = static_cast<Lane>(static_cast<int>(random() % 256) - 128);
    }
    for (std::size_t q = 0; q < errors.size(); ++q) {
      for (std::size_t n = 0; n < kCount + kFilterPadding; ++n)
        errors[q].push_back(static_cast<std::uint8_t>(random() % 60));
      input.errors[q] = errors[q].data();
    }
  }
  static constexpr std::uint32_t highest = sizeof(Lane) == 2 ? 256 : 65536;
};

template <typename Lane>
void expect_sums(std::size_t count) {
  std::mt19937 random(static_cast<unsigned>(count));
  const Lines<Lane> lines(random);
  std::vector<Lane> sums(count + kFilterPadding), rest(sums.size());
  std::vector<std::uint8_t> errors(sums.size());
  filter_run(lines.input, count, {sums.data(), rest.data(), errors.data()});
  for (std::size_t n = 0; n < count; ++n) {
    std::int64_t sum = 32, left = 64, error = 0;
    for (std::size_t q = 0; q < lines.values.size(); ++q) {
      if (lines.values[q][n] < 0) continue;
      sum += std::int64_t{lines.input.weights[q]} * lines.values[q][n];
      left -= lines.input.weights[q];
    }
    for (const auto& line : lines.errors) error += line[n];
    ASSERT_EQ(sums[n], static_cast<Lane>(sum)) << n;
    ASSERT_EQ(rest[n], left) << n;
    ASSERT_EQ(errors[n], std::min<std::int64_t>(error, 255)) << n;
  }
}

TEST(FilterRun, SumsWhatIsThereWithEveryInstructionSet) {
  for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    for (const std::size_t count : {1u, 7u, 16u, 33u, 64u, 150u}) {
      expect_sums<std::int16_t>(count);
      expect_sums<std::int32_t>(count);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace splatlas
