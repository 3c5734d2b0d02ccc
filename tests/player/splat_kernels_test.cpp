#include "player/splat_kernels.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "player/span_model.h"

namespace splatlas {
namespace {

/// Light of one voxel, by plane.
using Light4 = std::array<float, kPlanes>;
/// A scanline: voxels without extinction are not selected.
using Scanline = std::vector<Light4>;

/// Two rows of voxels as the kernels read them.
struct Rows {
  SliceSpans slice;
  std::span<const Span> near, far;

  Rows(const Scanline& near_voxels, const Scanline& far_voxels) {
    slice.first_span = {0};
    for (const Scanline* row : {&near_voxels, &far_voxels}) {
      const std::size_t first = slice.spans.size();
      for (std::uint32_t n = 0; n < row->size(); ++n) {
        if ((*row)[n][0] > 0) slice.add_voxel(first, n);
      }
      slice.first_span.push_back(static_cast<std::uint32_t>(slice.spans.size()));
    }
    slice.allocate_light();
    near = std::span(slice.spans).first(slice.first_span[1]);
    far = std::span(slice.spans).subspan(slice.first_span[1]);
    fill(near, near_voxels);
    fill(far, far_voxels);
  }

 private:
  void fill(std::span<const Span> spans, const Scanline& row) {
    for (const Span& span : spans) {
      const std::uint32_t end = (span.first_block + span.blocks) << kBlockBits;
      for (std::uint32_t n = span.first_block << kBlockBits; n < end && n < row.size(); ++n) {
        for (std::size_t plane = 0; plane < kPlanes; ++plane)
          slice.light[span.place(n) + plane * kBlock] = row[n][plane];
      }
    }
  }
};

/// An image row of `columns` pixels with its margins, and guards around those.
class Image {
 public:
  static constexpr std::int64_t kGuard = 8;

  explicit Image(std::int64_t columns)
      : columns_(columns), stride_(columns + 2 * (ImageRow::kMargin + kGuard)) {
    floats_.assign(static_cast<std::size_t>(4 * stride_), 0);
  }
  [[nodiscard]] ImageRow row() {
    return {floats_.data() + kGuard + ImageRow::kMargin, static_cast<std::size_t>(stride_), columns_};
  }
  [[nodiscard]] float& at(std::size_t plane, std::int64_t x) {
    return floats_[plane * static_cast<std::size_t>(stride_) +
                   static_cast<std::size_t>(kGuard + ImageRow::kMargin + x)];
  }
  [[nodiscard]] std::int64_t columns() const { return columns_; }
  friend bool operator==(const Image&, const Image&) = default;

 private:
  std::int64_t columns_, stride_;
  std::vector<float> floats_;
};

Image random_image(std::mt19937& random, std::int64_t columns) {
  std::uniform_real_distribution<float> value(0, 1);
  Image image(columns);
  for (std::size_t plane = 0; plane < 4; ++plane) {
    for (std::int64_t x = -ImageRow::kMargin - Image::kGuard; x < columns + ImageRow::kMargin + Image::kGuard;
         ++x)
      image.at(plane, x) = value(random);
  }
  return image;
}

/// Stretches of voxels and gaps of any length.
Scanline random_scanline(std::mt19937& random, float most_extinction) {
  std::uniform_real_distribution<float> value(0, 1);
  Scanline row(random() % 150);
  bool selected = false;
  std::size_t left = 0;
  for (Light4& voxel : row) {
    if (left-- == 0) {
      selected = !selected;
      left = random() % 40;
    }
    if (selected) voxel = {value(random) * most_extinction, value(random), value(random), value(random)};
  }
  return row;
}

float at(const Scanline& row, std::int64_t n, std::size_t plane) {
  return n >= 0 && n < static_cast<std::int64_t>(row.size()) ? row[static_cast<std::size_t>(n)][plane] : 0;
}

struct Case {
  Scanline near, far;
  Rows rows;
  SheetRow row;

  Case(std::mt19937& random, float most_extinction)
      : near(random_scanline(random, most_extinction)),
        far(random_scanline(random, most_extinction)),
        rows(near, far) {
    const float v = static_cast<float>(random() % 1000) / 1000;
    const float u = static_cast<float>(random() % 1000) / 1000;
    const auto shift = static_cast<std::int64_t>(random() % 120) - 60;
    row = {rows.slice.light.get(), rows.near, rows.far, 1 - v, v, 1 - u, u, shift};
  }
  /// From the definition.
  [[nodiscard]] double splatted(std::int64_t x, std::size_t plane) const {
    const auto mixed = [&](std::int64_t n) {
      return static_cast<double>(row.near_weight) * at(near, n, plane) +
             static_cast<double>(row.far_weight) * at(far, n, plane);
    };
    return row.here * mixed(x - row.shift) + row.before * mixed(x - row.shift - 1);
  }
};

class BothKernels : public testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] const SplatKernels& kernels() const { return GetParam() ? best_kernels() : scalar_kernels(); }
};
INSTANTIATE_TEST_SUITE_P(Kernels, BothKernels, testing::Bool(),
                         [](const auto& kernels) { return kernels.param ? "Best" : "Scalar"; });

TEST_P(BothKernels, CompositeTheDefinition) {
  std::mt19937 random(1);
  for (int n = 0; n < 600; ++n) {
    const float most_extinction =
        std::array{1e-8f, 1e-4f, 1e-2f, 1.0f, 10.0f, 1e4f}[static_cast<std::size_t>(n) % 6];
    const Case scene(random, most_extinction);
    Image image = random_image(random, 1 + random() % 120);
    Image before = image;
    const float slab_mm = 0.8f;
    kernels().composite(scene.row, slab_mm, 0, image.row());
    for (std::int64_t x = 0; x < image.columns(); ++x) {
      const double depth = scene.splatted(x, 0) * static_cast<double>(slab_mm);
      const double through = 1 - static_cast<double>(before.at(3, x));
      const double mean = depth > 0 ? -std::expm1(-depth) / depth : 1;
      for (std::size_t c = 0; c < 3; ++c) {
        // Emission may stand beside a voxel without extinction only where depth is above zero, too.
        const double added = through * static_cast<double>(slab_mm) * mean * scene.splatted(x, c + 1);
        const double expected = before.at(c, x) + added;
        ASSERT_NEAR(image.at(c, x), expected, 6e-8 * expected + 8e-7 * added)
            << kernels().name << ", scene " << n << ", pixel " << x << ", depth " << depth;
      }
      const double absorbed = -through * std::expm1(-depth);
      const double expected = before.at(3, x) + absorbed;
      ASSERT_NEAR(image.at(3, x), expected, 6e-8 * expected + 8e-7 * absorbed) << "depth " << depth;
      ASSERT_LE(image.at(3, x), 1);
    }
    for (std::size_t plane = 0; plane < 4; ++plane) {
      for (std::int64_t g = 1; g <= Image::kGuard; ++g) {
        ASSERT_EQ(image.at(plane, -ImageRow::kMargin - g), before.at(plane, -ImageRow::kMargin - g));
        const std::int64_t behind = image.columns() + ImageRow::kMargin + g - 1;
        ASSERT_EQ(image.at(plane, behind), before.at(plane, behind));
      }
    }
  }
}

/// What is added to black: the opacity itself, without cancellation, to a few units in the last place.
TEST_P(BothKernels, OpacityOfThinSlabsDoesNotCancel) {
  for (double depth = 1e-12; depth < 200; depth *= 1.37) {
    const auto extinction = static_cast<float>(depth);
    const Scanline voxels(40, Light4{extinction, extinction, 0, 0});
    const Rows rows(voxels, {});
    Image image(40);
    kernels().composite({rows.slice.light.get(), rows.near, {}, 1, 0, 1, 0, 0}, 1.0f, 0, image.row());
    const double expected = -std::expm1(-static_cast<double>(extinction));
    for (std::int64_t x = 0; x < 40; ++x) {
      ASSERT_NEAR(image.at(0, x) / expected, 1, 3e-7) << kernels().name << ", depth " << depth;
      ASSERT_NEAR(image.at(3, x) / expected, 1, 3e-7) << kernels().name << ", depth " << depth;
    }
  }
}

TEST_P(BothKernels, EmptyPixelsStayAsTheyAreBitForBit) {
  std::mt19937 random(3);
  Scanline voxels(40, Light4{});
  voxels[20] = {1, 1, 1, 1};
  const Rows rows(voxels, {});
  Image image = random_image(random, 40);
  Image before = image;
  kernels().composite({rows.slice.light.get(), rows.near, {}, 1, 0, 0.5f, 0.5f, 0}, 3.0f, 0, image.row());
  for (std::size_t plane = 0; plane < 4; ++plane) {
    for (std::int64_t x = 0; x < 40; ++x) {
      if (x == 20 || x == 21) {
        EXPECT_NE(image.at(plane, x), before.at(plane, x));
      } else {
        EXPECT_EQ(image.at(plane, x), before.at(plane, x)) << plane << ' ' << x;
      }
    }
  }
}

/// Blocks are those of the scanline: voxels 16 to 31 here, seen by pixels 21 to 36.
TEST_P(BothKernels, OpaqueBlocksAreLeftAsTheyAreAndTheNextOneGetsItsFootprint) {
  const Scanline voxels(48, Light4{1, 1, 1, 1});
  const Rows rows(voxels, {});
  const SheetRow row{rows.slice.light.get(), rows.near, {}, 1, 0, 0.25f, 0.75f, 5};
  constexpr float kFloor = 0.125f;
  Image nowhere(60);
  kernels().composite(row, 1.0f, kFloor, nowhere.row());
  Image image(60);
  for (std::int64_t x = 21; x <= 36; ++x) image.at(3, x) = 0.875f;
  kernels().composite(row, 1.0f, kFloor, image.row());
  for (std::int64_t x = 0; x < 60; ++x) {
    const bool opaque = x >= 21 && x <= 36;
    EXPECT_EQ(image.at(0, x), opaque ? 0 : nowhere.at(0, x)) << kernels().name << ' ' << x;
  }
  image = Image(60);
  for (std::int64_t x = 21; x <= 36; ++x) image.at(3, x) = x == 30 ? 0.874f : 0.875f;
  kernels().composite(row, 1.0f, kFloor, image.row());
  for (std::int64_t x = 21; x <= 36; ++x) EXPECT_GT(image.at(0, x), 0) << "one pixel is not opaque";
}

TEST(SplatKernels, BestAgreesWithScalar) {
  std::mt19937 random(4);
  for (int n = 0; n < 300; ++n) {
    const Case scene(random, n % 3 == 0 ? 5.0f : 0.5f);
    Image best = random_image(random, 1 + random() % 120);
    Image scalar = best;
    best_kernels().composite(scene.row, 1.7f, 1e-4f, best.row());
    scalar_kernels().composite(scene.row, 1.7f, 1e-4f, scalar.row());
    for (std::size_t plane = 0; plane < 4; ++plane) {
      for (std::int64_t x = 0; x < best.columns(); ++x) {
        ASSERT_NEAR(best.at(plane, x), scalar.at(plane, x), 1e-6 * std::max(1.0f, scalar.at(plane, x)));
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
