#include "player/render/decode/sparse_bytes.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

TEST(SparseBytes, IsZeroUntilWritten) {
  for (const std::size_t bytes : {std::size_t{1}, 2 * kMiB - 1, 2 * kMiB, 5 * kMiB + 3}) {
    auto sparse = value_or_throw(SparseBytes::reserve(bytes));
    ASSERT_EQ(sparse.size(), bytes);
    sparse.expect_dense();
    const auto all_are = [&](std::byte value) {
      return std::all_of(sparse.data(), sparse.data() + bytes, [&](std::byte b) { return b == value; });
    };
    EXPECT_TRUE(all_are(std::byte{0}));
    std::fill_n(sparse.data(), bytes, std::byte{3});
    EXPECT_TRUE(all_are(std::byte{3}));
    sparse.drop(1);
    EXPECT_EQ(sparse.data()[0], std::byte{3});
    EXPECT_EQ(sparse.data()[bytes - 1], bytes == 1 ? std::byte{3} : std::byte{0});
  }
}

/// A quarter of a terabyte, as for a grid of which a selection uses little.
TEST(SparseBytes, TakesAddressSpaceOnly) {
  auto sparse = value_or_throw(SparseBytes::reserve(std::size_t{1} << 38));
  sparse.data()[std::size_t{1} << 37] = std::byte{1};
  EXPECT_EQ(sparse.data()[(std::size_t{1} << 37) + 1], std::byte{0});
}

TEST(SparseBytes, SaysWhenThereIsNoAddressSpace) {
  for (const std::uint64_t bytes : {std::uint64_t{1} << 62, ~std::uint64_t{0}})
    EXPECT_THAT(SparseBytes::reserve(bytes), FailsWith(ErrorCode::kLimit, testing::_));
}

}  // namespace
}  // namespace splatlas
