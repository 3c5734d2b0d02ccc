// Test volumes and picture comparison for peers.
#pragma once

#include <gtest/gtest.h>

#include "player/picture.h"
#include "tests/reference/masked_volume.h"
#include "tests/reference/reference_picture.h"

namespace splatlas {

inline void put_box(reference::MaskedVolume& volume, const Index3& low, std::int64_t side,
                    std::uint8_t grey) {
  for (std::int64_t k = low[2]; k < low[2] + side; ++k) {
    for (std::int64_t j = low[1]; j < low[1] + side; ++j) {
      for (std::int64_t i = low[0]; i < low[0] + side; ++i)
        volume.greys[static_cast<std::size_t>(volume.grid.offset(i, j, k))] = grey;
    }
  }
}

/// Sum and centroid of opacities.
struct Blob {
  double sum = 0, x = 0, y = 0;
};
template <typename AlphaAt>
Blob blob(const PictureSize& size, const AlphaAt& alpha_at) {
  Blob blob;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double alpha = alpha_at(x, y);
      blob.sum += alpha;
      blob.x += alpha * x;
      blob.y += alpha * y;
    }
  }
  blob.x /= blob.sum;
  blob.y /= blob.sum;
  return blob;
}

/// Expects equal centroids, to `pixels`, and sums, to a share of `sum`.
inline void expect_same_blob(const Picture& picture, const reference::ReferencePicture& expected,
                             double pixels, double sum) {
  ASSERT_EQ(picture.size, expected.size);
  const Blob there = blob(expected.size, [&](int x, int y) {
    return expected.pixels[static_cast<std::size_t>(y * expected.size.width + x)][3];
  });
  const Blob here =
      blob(expected.size, [&](int x, int y) { return static_cast<double>(picture.at(x, y)[3]); });
  EXPECT_NEAR(here.x, there.x, pixels);
  EXPECT_NEAR(here.y, there.y, pixels);
  EXPECT_NEAR(here.sum, there.sum, sum * there.sum);
}

}  // namespace splatlas
