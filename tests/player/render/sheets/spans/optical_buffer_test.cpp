#include <algorithm>

#include <gtest/gtest.h>

#include "player/render/sheets/spans/span_model.h"

namespace splatlas {
namespace {

constexpr std::size_t kMiB = (std::size_t{1} << 20) / sizeof(float);  // in floats

/// A buffer of `floats` equal values.
OpticalBuffer filled(OpticalArena& arena, std::size_t floats, float value) {
  OpticalBuffer buffer = arena.lend(floats);
  EXPECT_GE(buffer.capacity(), floats);
  std::fill_n(buffer.append(floats), floats, value);
  arena.settle(buffer);
  return buffer;
}

bool holds(const OpticalBuffer& buffer, float value) {
  return std::all_of(buffer.data(), buffer.data() + buffer.size(), [=](float f) { return f == value; });
}

TEST(OpticalBuffer, KeepsWhatItHoldsWhereItGrows) {
  OpticalBuffer buffer;
  for (std::size_t n = 0; n < 3000; ++n) {
    *buffer.append(1) = static_cast<float>(n);
    ASSERT_EQ(buffer.size(), n + 1);
    ASSERT_LE(buffer.size(), buffer.capacity());
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % 64, 0u);
  }
  for (std::size_t n = 0; n < 3000; ++n) ASSERT_EQ(buffer.data()[n], static_cast<float>(n));
}

TEST(OpticalArena, BuffersLieApartAndAligned) {
  OpticalArena arena;
  std::vector<OpticalBuffer> buffers;
  for (std::size_t n = 0; n < 300; ++n) buffers.push_back(filled(arena, 1 + n * n, static_cast<float>(n)));
  for (std::size_t n = 0; n < buffers.size(); ++n) {
    EXPECT_EQ(buffers[n].size(), 1 + n * n);
    EXPECT_TRUE(holds(buffers[n], static_cast<float>(n)));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffers[n].data()) % 64, 0u);
  }
  // Two buffers lent at the same time, as for two threads.
  OpticalBuffer a = arena.lend(100), b = arena.lend(100);
  std::fill_n(a.append(100), 100, 1.0f);
  std::fill_n(b.append(100), 100, 2.0f);
  arena.settle(b);
  arena.settle(a);
  EXPECT_TRUE(holds(a, 1) && holds(b, 2));
}

TEST(OpticalArena, MemoryIsUsedAgainWhenNothingInItIsHeld) {
  OpticalArena arena;
  const auto fill = [&] {
    std::vector<OpticalBuffer> buffers;
    for (int n = 0; n < 40; ++n) buffers.push_back(filled(arena, kMiB / 3, static_cast<float>(n)));
    return buffers;
  };
  std::vector<OpticalBuffer> buffers = fill();
  const std::uint64_t bytes = arena.bytes();
  EXPECT_EQ(arena.bytes_in_use(), bytes);
  for (int again = 0; again < 5; ++again) {
    buffers.clear();
    EXPECT_EQ(arena.bytes_in_use(), 0u);
    buffers = fill();
    EXPECT_EQ(arena.bytes(), bytes);
  }
  // A buffer that stays keeps others off its memory, and is not overwritten.
  OpticalBuffer stays = std::move(buffers[20]);
  buffers.clear();
  EXPECT_GE(arena.bytes_in_use(), stays.size() * sizeof(float));
  EXPECT_LT(arena.bytes_in_use(), bytes / 3);
  buffers = fill();
  EXPECT_TRUE(holds(stays, 20));
}

TEST(OpticalArena, GivesBackWhatNobodyUses) {
  OpticalArena arena;
  const OpticalBuffer used = filled(arena, kMiB, 1);
  {
    const OpticalBuffer dropped = filled(arena, 8 * kMiB, 2);  // too large for shared memory
  }
  const std::uint64_t bytes = arena.bytes();
  arena.trim(bytes);
  EXPECT_EQ(arena.bytes(), bytes);
  arena.trim(0);
  EXPECT_EQ(arena.bytes(), arena.bytes_in_use());
  EXPECT_LT(arena.bytes(), bytes);
  EXPECT_TRUE(holds(used, 1));
}

/// A buffer that outgrows its room moves, and overwrites no other.
TEST(OpticalArena, ABufferMayOutgrowItsRoom) {
  OpticalArena arena;
  const OpticalBuffer before = filled(arena, 1000, 1);
  OpticalBuffer grown = arena.lend(10);
  const std::size_t floats = grown.capacity() + 5;
  std::fill_n(grown.append(floats), floats, 2.0f);
  arena.settle(grown);
  const OpticalBuffer behind = filled(arena, 1000, 3);
  EXPECT_TRUE(holds(before, 1) && holds(grown, 2) && holds(behind, 3));
}

TEST(OpticalArena, WhatHoldsNothingKeepsNothing) {
  OpticalArena arena;
  const OpticalBuffer empty = filled(arena, 0, 0);
  EXPECT_EQ(empty.capacity(), 0u);
  EXPECT_EQ(arena.bytes_in_use(), 0u);
}

}  // namespace
}  // namespace splatlas
