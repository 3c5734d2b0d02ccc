#include "format/codec/range_coder.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace splatlas {
namespace {

std::vector<std::byte> encode(const std::vector<bool>& bits, std::size_t models) {
  std::vector<AdaptiveBit> of(models);
  RangeEncoder encoder;
  for (std::size_t n = 0; n < bits.size(); ++n) encoder.encode(of[n % models], bits[n]);
  return encoder.finish();
}

TEST(AdaptiveBit, IsTheMeanOfTheBitsSeen) {
  AdaptiveBit model{.probability = 0x8000, .seen = 0};
  model.learn(true);
  EXPECT_EQ(model.probability, 65520);
  model.learn(false);
  EXPECT_EQ(model.probability, 32760);
  model.learn(true);
  EXPECT_NEAR(model.probability, 65536 * 2 / 3, 12);
  for (int n = 0; n < 5000; ++n) model.learn(false);
  EXPECT_EQ(model.probability, 16);
  EXPECT_EQ(model.seen, 255);
}

RC_GTEST_PROP(RangeCoder, GivesBitsBack, ()) {
  const std::size_t models = *rc::gen::inRange<std::size_t>(1, 4);
  const unsigned rare = *rc::gen::element(1u, 2u, 50u, 5000u);
  auto bits = *rc::gen::container<std::vector<bool>>(
      *rc::gen::inRange<std::size_t>(0, 4000),
      rc::gen::map(rc::gen::inRange(0u, rare), [](unsigned n) { return n == 0; }));
  const std::vector<std::byte> bytes = encode(bits, models);
  if (!bytes.empty()) RC_ASSERT(bytes.back() != std::byte{0});
  std::vector<AdaptiveBit> of(models);
  RangeDecoder decoder(bytes);
  for (std::size_t n = 0; n < bits.size(); ++n) RC_ASSERT(decoder.decode(of[n % models]) == bits[n]);
  RC_ASSERT(decoder.at_end());
}

TEST(RangeCoder, TakesWhatTheBitsTell) {
  // One bit in 16 is set: 0.337 bits each. Learning the probability costs little.
  std::vector<bool> bits;
  std::uint32_t state = 1;
  double set = 0;
  for (int n = 0; n < 100000; ++n) {
    state = state * 1664525 + 1013904223;
    bits.push_back(state >> 28 == 0);
    set += bits.back() ? 1 : 0;
  }
  const double p = set / 100000, told = -(p * std::log2(p) + (1 - p) * std::log2(1 - p)) * 100000 / 8;
  const auto bytes = static_cast<double>(encode(bits, 1).size());
  EXPECT_GE(bytes, told);
  EXPECT_LE(bytes, 1.02 * told);
}

TEST(RangeDecoder, KnowsBytesThatAreLeft) {
  const std::vector<std::byte> none, many(20, std::byte{1});
  AdaptiveBit model;
  RangeDecoder of_none(none), of_many(many);
  EXPECT_TRUE(of_none.at_end());
  EXPECT_TRUE(of_none.decode(model));
  EXPECT_FALSE(of_many.at_end());
}

}  // namespace
}  // namespace splatlas
