#include "player/render/sheets/splat/splat_kernels.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "player/render/sheets/spans/span_writer.h"
#include "tests/support/every_kernel.h"

namespace splatlas {
namespace {

/// Optical properties of one voxel: extinction, then emissions.
using Optics4 = std::array<float, 4>;
/// Scanline; voxels without extinction are not selected.
using Scanline = std::vector<Optics4>;

/// A slice with rows of voxels, in the layout of the kernels.
SliceSpans slice_of(const std::vector<Scanline>& rows, int emissions) {
  SliceSpans slice;
  SpanWriter writer(emissions, slice);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::uint32_t n = 0; n < rows[r].size(); ++n) {
      if (rows[r][n][0] <= 0) continue;
      writer.add(n, 1);
      *writer.extinctions(n) = rows[r][n][0];
      *writer.whites(n) = emissions == 1 ? rows[r][n][1] : 1;
      writer.color(n, 1, {rows[r][n][1], rows[r][n][2], rows[r][n][3]});
    }
    writer.end_row(static_cast<std::int64_t>(r));
  }
  writer.finish();
  return slice;
}

/// Phase rows of an image, with margins and guard pixels.
class Image {
 public:
  static constexpr std::int64_t kGuard = 8;

  Image(std::int64_t columns, std::size_t phase_rows, std::size_t planes)
      : columns_(columns),
        stride_(columns + 2 * (ImageRows::kMargin + kGuard)),
        phase_rows_(phase_rows),
        planes_(planes),
        floats_(phase_rows * planes * static_cast<std::size_t>(stride_) + kGuard + ImageRows::kMargin) {}

  /// Order: rows between a pair, then phases.
  [[nodiscard]] ImageRows rows(std::size_t phases, std::size_t rows_between) {
    const auto plane_floats = stride_ * static_cast<std::int64_t>(planes_);
    const auto row_floats = plane_floats * static_cast<std::int64_t>(phases);
    return {floats_.data() + kGuard + ImageRows::kMargin,        columns_, stride_, plane_floats, row_floats,
            row_floats * static_cast<std::int64_t>(rows_between)};
  }
  [[nodiscard]] float& at(std::size_t phase_row, std::size_t plane, std::int64_t x) {
    return floats_[(phase_row * planes_ + plane) * static_cast<std::size_t>(stride_) +
                   static_cast<std::size_t>(kGuard + ImageRows::kMargin + x)];
  }
  [[nodiscard]] std::int64_t columns() const { return columns_; }
  [[nodiscard]] std::size_t phase_rows() const { return phase_rows_; }
  [[nodiscard]] std::size_t planes() const { return planes_; }

  void fill(std::mt19937& random) {
    std::uniform_real_distribution<float> value(0, 1);
    for (float& f : floats_) f = value(random);
  }

 private:
  std::int64_t columns_, stride_;
  std::size_t phase_rows_, planes_;
  std::vector<float> floats_;
};

/// Runs of voxels and gaps of any length.
Scanline random_scanline(std::mt19937& random, float max_extinction) {
  std::uniform_real_distribution<float> value(0, 1);
  Scanline row(random() % 150);
  bool selected = false;
  std::size_t left = 0;
  for (Optics4& voxel : row) {
    if (left-- == 0) {
      selected = !selected;
      left = random() % 40;
    }
    if (selected) voxel = {value(random) * max_extinction, value(random), value(random), value(random)};
  }
  return row;
}

/// Voxel rows, and the pixel rows between them. Some pairs reach beyond the slice.
struct Case {
  std::vector<Scanline> voxels;
  SliceSpans slice;
  SheetRows rows;

  Case(std::mt19937& random, float max_extinction) {
    for (std::size_t n = random() % 4; n < 4; ++n) voxels.push_back(random_scanline(random, max_extinction));
    slice = slice_of(voxels, random() % 2 == 0 ? 1 : 3);
    rows.slice = &slice;
    rows.upper = -1 + static_cast<std::int64_t>(random() % 2);
    rows.pairs = static_cast<std::int64_t>(random() % (voxels.size() + 2));
    rows.rows_between = 1 + random() % SheetRows::kMaxRows;
    rows.phase_count = 1 + random() % SheetRows::kMaxPhases;
    for (float& weight : rows.lower_weights) weight = part(random);
    const auto shift = static_cast<std::int64_t>(random() % 120) - 60;
    for (Phase& phase : rows.phases) phase = {part(random), shift + static_cast<std::int64_t>(random() % 2)};
  }
  Case(const Case&) = delete;
  Case& operator=(const Case&) = delete;

  [[nodiscard]] Image image(std::mt19937& random) const {
    Image image = black_image(1 + random() % 120);
    image.fill(random);
    return image;
  }
  [[nodiscard]] Image black_image(std::int64_t columns = 120) const {
    return {columns, static_cast<std::size_t>(rows.pairs) * rows.rows_between * rows.phase_count,
            1 + static_cast<std::size_t>(slice.emissions)};
  }
  void composite(const SplatKernels& kernels, float slab_mm, float threshold, Image& image) const {
    kernels.composite(rows, {}, slab_mm, threshold, image.rows(rows.phase_count, rows.rows_between));
  }

  /// The definition, in double precision.
  [[nodiscard]] double splatted(std::size_t phase_row, std::int64_t x, std::size_t plane) const {
    return weigh(phase_row, x, plane, [](double first, double second, double weight) {
      return (1 - weight) * first + weight * second;
    });
  }
  /// The maximum of the interpolated voxels, the scale of rounding errors.
  [[nodiscard]] double largest(std::size_t phase_row, std::int64_t x, std::size_t plane) const {
    return weigh(phase_row, x, plane,
                 [](double first, double second, double) { return std::max(first, second); });
  }

 private:
  static float part(std::mt19937& random) { return static_cast<float>(random() % 1000) / 1000; }

  [[nodiscard]] double voxel(std::int64_t row, std::int64_t n, std::size_t plane) const {
    if (row < 0 || row >= static_cast<std::int64_t>(voxels.size()) || n < 0) return 0;
    const Scanline& line = voxels[static_cast<std::size_t>(row)];
    return n < static_cast<std::int64_t>(line.size()) ? line[static_cast<std::size_t>(n)][plane] : 0;
  }
  template <typename Mix>
  [[nodiscard]] double weigh(std::size_t phase_row, std::int64_t x, std::size_t plane, const Mix& mix) const {
    const Phase& phase = rows.phases[phase_row % rows.phase_count];
    const std::size_t row = phase_row / rows.phase_count;
    const float lower_weight = rows.lower_weights[row % rows.rows_between];
    const std::int64_t upper = rows.upper + static_cast<std::int64_t>(row / rows.rows_between);
    const auto mixed = [&](std::int64_t n) {
      return mix(voxel(upper, n, plane), voxel(upper + 1, n, plane), static_cast<double>(lower_weight));
    };
    return mix(mixed(x - phase.shift), mixed(x - phase.shift - 1), static_cast<double>(phase.before));
  }
};

/// One pixel row on one voxel row.
SheetRows upon(const SliceSpans& slice, const Phase& phase) {
  SheetRows rows;
  rows.slice = &slice;
  rows.pairs = 1;
  rows.phases[0] = phase;
  return rows;
}

class SplatKernelsOf : public EveryKernel {
 protected:
  [[nodiscard]] static SplatKernels kernels() { return is_reference() ? scalar_kernels() : best_kernels(); }
};
INSTANTIATE_TEST_SUITE_P(Every, SplatKernelsOf, testing::ValuesIn(targets_and_reference()), kernel_name);

TEST_P(SplatKernelsOf, CompositeTheDefinition) {
  std::mt19937 random(1);
  std::size_t compared = 0;
  for (int n = 0; n < 600; ++n) {
    const float max_extinction =
        std::array{1e-8f, 1e-4f, 1e-2f, 1.0f, 5.0f, 10.0f, 1e4f}[static_cast<std::size_t>(n) % 7];
    const Case scene(random, max_extinction);
    Image image = scene.image(random);
    Image before = image;
    const double slab_mm = 0.8f;
    scene.composite(kernels(), 0.8f, 0, image);
    const std::size_t opacity = image.planes() - 1;
    for (std::size_t s = 0; s < image.phase_rows(); ++s) {
      for (std::int64_t x = 0; x < image.columns(); ++x) {
        const double depth = scene.splatted(s, x, 0) * slab_mm;
        const double transmittance = 1 - static_cast<double>(before.at(s, opacity, x));
        const double mean = depth > 0 ? -std::expm1(-depth) / depth : 1;
        // Optical properties are interpolated in three steps, each rounded relative to the voxels.
        const double depth_error = 2.5e-7 * scene.largest(s, x, 0) * slab_mm;
        for (std::size_t c = 0; c < opacity; ++c) {
          const double weight = transmittance * slab_mm * mean;
          const double added = weight * scene.splatted(s, x, c + 1);
          const double expected = static_cast<double>(before.at(s, c, x)) + added;
          const double error = 6e-8 * expected + 8e-7 * added + added * depth_error +
                               weight * 2.5e-7 * scene.largest(s, x, c + 1);
          ASSERT_NEAR(image.at(s, c, x), expected, error)
              << "scene " << n << ", pixel " << x << ", depth " << depth;
        }
        const double absorbed = -transmittance * std::expm1(-depth);
        const double expected = static_cast<double>(before.at(s, opacity, x)) + absorbed;
        const double error =
            6e-8 * expected + 8e-7 * absorbed + transmittance * depth_error * std::exp(-depth);
        ASSERT_NEAR(image.at(s, opacity, x), expected, error) << "depth " << depth;
        ASSERT_LE(image.at(s, opacity, x), 1);
        ++compared;
      }
      for (std::size_t plane = 0; plane < image.planes(); ++plane) {
        for (std::int64_t g = 1; g <= Image::kGuard; ++g) {
          ASSERT_EQ(image.at(s, plane, -ImageRows::kMargin - g),
                    before.at(s, plane, -ImageRows::kMargin - g));
          const std::int64_t behind = image.columns() + ImageRows::kMargin + g - 1;
          ASSERT_EQ(image.at(s, plane, behind), before.at(s, plane, behind));
        }
      }
    }
  }
  EXPECT_GT(compared, 100000u);
}

/// On black the result is the opacity itself: no cancellation, to a few units in the last place.
TEST_P(SplatKernelsOf, OpacityOfThinSlabsDoesNotCancel) {
  for (double depth = 1e-12; depth < 200; depth *= 1.37) {
    const auto extinction = static_cast<float>(depth);
    const SliceSpans slice = slice_of({Scanline(40, Optics4{extinction, extinction, 0, 0})}, 3);
    Image image(40, 1, 4);
    kernels().composite(upon(slice, {}), {}, 1.0f, 0, image.rows(1, 1));
    const double expected = -std::expm1(-static_cast<double>(extinction));
    for (std::int64_t x = 0; x < 40; ++x) {
      ASSERT_NEAR(image.at(0, 0, x) / expected, 1, 3e-7) << "depth " << depth;
      ASSERT_NEAR(image.at(0, 3, x) / expected, 1, 3e-7) << "depth " << depth;
    }
  }
}

TEST_P(SplatKernelsOf, EmptyPixelsStayAsTheyAreBitForBit) {
  std::mt19937 random(3);
  Scanline voxels(40, Optics4{});
  voxels[20] = {1, 1, 1, 1};
  const SliceSpans slice = slice_of({voxels}, 3);
  Image image(40, 1, 4);
  image.fill(random);
  Image before = image;
  kernels().composite(upon(slice, {0.5f, 0}), {}, 3.0f, 0, image.rows(1, 1));
  for (std::size_t plane = 0; plane < 4; ++plane) {
    for (std::int64_t x = 0; x < 40; ++x) {
      if (x == 20 || x == 21) {
        EXPECT_NE(image.at(0, plane, x), before.at(0, plane, x));
      } else {
        EXPECT_EQ(image.at(0, plane, x), before.at(0, plane, x)) << plane << ' ' << x;
      }
    }
  }
}

/// Blocks belong to the scanline: voxels 16 to 31 here, in pixels 21 to 36.
TEST_P(SplatKernelsOf, OpaqueBlocksStayAndTheNextOneGetsItsFootprint) {
  const SliceSpans slice = slice_of({Scanline(48, Optics4{1, 1, 1, 1})}, 1);
  const SheetRows rows = upon(slice, {0.75f, 5});
  constexpr float kThreshold = 0.125f;
  Image nowhere(60, 1, 2);
  kernels().composite(rows, {}, 1.0f, kThreshold, nowhere.rows(1, 1));
  Image image(60, 1, 2);
  for (std::int64_t x = 21; x <= 36; ++x) image.at(0, 1, x) = 0.875f;
  kernels().composite(rows, {}, 1.0f, kThreshold, image.rows(1, 1));
  for (std::int64_t x = 0; x < 60; ++x) {
    const bool opaque = x >= 21 && x <= 36;
    EXPECT_EQ(image.at(0, 0, x), opaque ? 0 : nowhere.at(0, 0, x)) << x;
  }
  image = Image(60, 1, 2);
  constexpr float kAlmost = 0.874f;
  for (std::int64_t x = 21; x <= 36; ++x) image.at(0, 1, x) = x == 30 ? kAlmost : 0.875f;
  kernels().composite(rows, {}, 1.0f, kThreshold, image.rows(1, 1));
  EXPECT_NEAR(image.at(0, 0, 30), (1 - kAlmost) * nowhere.at(0, 0, 30), 1e-7) << "it is not opaque";
  for (std::int64_t x = 21; x <= 36; ++x) {
    EXPECT_GT(image.at(0, 0, x), 0) << "one pixel is not opaque";
    if (x == 30) continue;
    EXPECT_NEAR(image.at(0, 0, x), 0.125f * nowhere.at(0, 0, x), 1e-7) << x;
  }
}

/// Composites shifted slices until much is opaque. The record of opaque pixels is true, without effect.
TEST_P(SplatKernelsOf, RecordedOpaquePixelsHaveNoEffect) {
  constexpr float kThreshold = 1e-3f;
  std::mt19937 random(5);
  std::int64_t known_pixels = 0;
  for (int n = 0; n < 100; ++n) {
    Case scene(random, 8.0f);
    Image with = scene.black_image();
    Image without = with;
    std::vector<OpaquePixels> opaque(with.phase_rows());
    ImageRows rows = with.rows(scene.rows.phase_count, scene.rows.rows_between);
    rows.opaque = opaque.data();
    rows.opaque_row_stride = static_cast<std::int64_t>(scene.rows.phase_count);
    rows.opaque_pair_stride = rows.opaque_row_stride * static_cast<std::int64_t>(scene.rows.rows_between);
    for (int slice = 0; slice < 12; ++slice) {
      kernels().composite(scene.rows, {}, 0.9f, kThreshold, rows);
      scene.composite(kernels(), 0.9f, kThreshold, without);
      for (Phase& phase : scene.rows.phases) phase.shift += slice % 4 == 0 ? 1 : 0;
    }
    for (std::size_t s = 0; s < with.phase_rows(); ++s) {
      for (std::size_t plane = 0; plane < with.planes(); ++plane) {
        for (std::int64_t x = 0; x < with.columns(); ++x)
          ASSERT_EQ(with.at(s, plane, x), without.at(s, plane, x)) << "scene " << n;
      }
      for (std::int64_t x = opaque[s].first; x < opaque[s].last; ++x)
        ASSERT_GE(with.at(s, with.planes() - 1, x), 1 - kThreshold) << "pixel " << x;
      known_pixels += opaque[s].last - opaque[s].first;
    }
  }
  EXPECT_GT(known_pixels, 2000);
}

/// Slabs cut by up to three planes: the definition with the kept fraction of each pixel.
TEST_P(SplatKernelsOf, CompositeCutSlabs) {
  std::mt19937 random(5);
  for (int n = 0; n < 200; ++n) {
    const Case scene(random, 0.5f);
    Image image = scene.black_image(1 + random() % 120);
    ClipRows kept;
    kept.planes = 1 + static_cast<int>(random() % 3);
    kept.entering = static_cast<int>(random() % static_cast<std::size_t>(kept.planes + 1));
    kept.phase_stride = kept.planes;
    kept.row_stride = kept.planes * static_cast<std::int64_t>(scene.rows.phase_count);
    kept.pair_stride = kept.row_stride * static_cast<std::int64_t>(scene.rows.rows_between);
    std::vector<ClipLine> lines;
    for (std::size_t line = 0; line < image.phase_rows() * static_cast<std::size_t>(kept.planes); ++line) {
      lines.push_back({static_cast<float>(random() % 100) / 100,
                       std::array{0.0f, 0.03f, -0.2f, 8.0f}[random() % 4],
                       static_cast<std::int32_t>(random() % 120)});
    }
    const auto fraction = [&](std::size_t phase_row, std::int64_t x) {
      double entering = 1, leaving = 1;
      for (int plane = 0; plane < kept.planes; ++plane) {
        const ClipLine& line =
            lines[phase_row * static_cast<std::size_t>(kept.planes) + static_cast<std::size_t>(plane)];
        const double at = static_cast<double>(line.at_whole) +
                          static_cast<double>(line.per_pixel) * static_cast<double>(x - line.whole);
        double& sum = plane < kept.entering ? entering : leaving;
        sum = std::min(sum, std::clamp(at, 0.0, 1.0));
      }
      return std::max(0.0, entering + leaving - 1);
    };
    const std::vector<ClipPixels> pixels(static_cast<std::size_t>(scene.rows.pairs),
                                         {0, image.columns(), 0, 0});
    kept.pixels = pixels.data();
    kept.lines = lines.data();
    kernels().composite(scene.rows, kept, 0.8f, 0,
                        image.rows(scene.rows.phase_count, scene.rows.rows_between));
    for (std::size_t s = 0; s < image.phase_rows(); ++s) {
      for (std::int64_t x = 0; x < image.columns(); ++x) {
        const double depth = scene.splatted(s, x, 0) * 0.8f * fraction(s, x);
        ASSERT_NEAR(image.at(s, image.planes() - 1, x), -std::expm1(-depth), 3e-6) << "scene " << n;
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
