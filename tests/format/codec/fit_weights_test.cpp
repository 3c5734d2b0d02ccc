#include <random>

#include <gtest/gtest.h>

#include "format/codec/value_codec.h"

namespace splatlas {
namespace {

using Neighbours = std::array<float, kNeighbours.size()>;

Neighbours random_neighbours(std::mt19937& random) {
  Neighbours neighbours{};
  for (float& value : neighbours) value = static_cast<float>(static_cast<int>(random() % 101) - 50);
  return neighbours;
}

TEST(WeightFit, FindsTheWeightsThatValuesWereMadeOf) {
  const ValueWeights made{36, 37, 6, -15, -15, -12, 2, 5, -4, 4, -2, 1, -128, 127};
  std::mt19937 random(1);
  WeightFit fit;
  for (int n = 0; n < 1000; ++n) {
    const Neighbours neighbours = random_neighbours(random);
    float value = 0;
    for (std::size_t q = 0; q < made.size(); ++q)
      value += neighbours[q] * static_cast<float>(made[q]) / kWeightUnit;
    fit.add(neighbours, value, static_cast<float>(1 + random() % 4));
  }
  EXPECT_EQ(fit.weights(), made);
}

TEST(WeightFit, WhatCountsMoreWins) {
  // Half of the voxels call for 1/2 of the first neighbour, the others for 1/4, a thousandth as strongly.
  std::mt19937 random(1);
  WeightFit fit;
  for (int n = 0; n < 1000; ++n) {
    const Neighbours neighbours = random_neighbours(random);
    fit.add(neighbours, neighbours[0] * (n % 2 == 0 ? 0.5f : 0.25f), n % 2 == 0 ? 1.0f : 0.001f);
  }
  ValueWeights expected{};
  expected[0] = 32;
  EXPECT_EQ(fit.weights(), expected);
}

TEST(WeightFit, BoundsWeightsAndTakesVoxelsThatSayNothing) {
  WeightFit steep, flat;
  for (int n = 0; n < 300; ++n) {
    Neighbours neighbours{};
    flat.add(neighbours, 0, 1);
    neighbours[3] = static_cast<float>(n % 7);
    neighbours[4] = static_cast<float>(n % 5);
    steep.add(neighbours, 9 * neighbours[3] - 9 * neighbours[4], 1);
  }
  EXPECT_EQ(flat.weights(), ValueWeights{});
  EXPECT_EQ(steep.weights()[3], 127);
  EXPECT_EQ(steep.weights()[4], -128);
}

TEST(WeightFit, FewVoxelsTakeTheMean) {
  WeightFit fit;
  for (int n = 0; n < 299; ++n) fit.add({1}, 1, 1);
  EXPECT_EQ(fit.weights(), kMeanWeights);
}

}  // namespace
}  // namespace splatlas
