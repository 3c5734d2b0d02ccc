#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "player/sheets/block_runs.h"
#include "player/sheets/splat_kernels.h"

namespace splatlas {
namespace {

/// Light of one voxel of the mixed row: extinction, then emissions.
using Mixed = std::array<float, 4>;

/// The rows of pixels between one pair of rows of voxels.
class PairSplat {
 public:
  PairSplat(const SheetRows& rows, float slab_mm, float floor, const ImageRows& image, std::int64_t pair)
      : rows_(rows), image_(image), slab_mm_(slab_mm), floor_(floor), pair_(pair) {}

  void composite() {
    BlockRuns runs(rows_, pair_, blocks_in_reach(rows_, image_));
    std::int64_t next_block = 0;
    for (BlockRun run; runs.next(run);) {
      if (run.first != next_block) before_ = {};
      next_block = run.last;
      for (std::int64_t block = run.first; block < run.last; ++block) composite_block(run, block);
    }
  }

 private:
  [[nodiscard]] std::size_t planes() const { return 1 + static_cast<std::size_t>(rows_.slice->emissions); }

  [[nodiscard]] float* pixels(std::size_t row, std::size_t phase, std::int64_t block) const {
    return image_.pixels + pair_ * image_.pair_stride + static_cast<std::int64_t>(row) * image_.row_stride +
           static_cast<std::int64_t>(phase) * image_.phase_stride + block * kBlock +
           rows_.phases[phase].shift;
  }
  /// In all rows and phases.
  [[nodiscard]] bool opaque(std::int64_t block) const {
    for (std::size_t row = 0; row < rows_.rows_between; ++row) {
      for (std::size_t phase = 0; phase < rows_.phase_count; ++phase) {
        const float* opacity = pixels(row, phase, block) + rows_.slice->emissions * image_.plane_stride;
        if (!std::all_of(opacity, opacity + kBlock, [&](float o) { return o >= 1 - floor_; })) return false;
      }
    }
    return true;
  }

  void composite_block(const BlockRun& run, std::int64_t block) {
    const float* upper = run.upper.light(block, rows_.slice->block_floats(), kDarkBlock.data());
    const float* lower = run.lower.light(block, rows_.slice->block_floats(), kDarkBlock.data());
    const bool passed_over = opaque(block);
    for (std::size_t row = 0; row < rows_.rows_between; ++row) {
      const float weight = rows_.lower_weights[row];
      for (std::int64_t n = 0; n < kBlock; ++n) {
        const auto here = mix(weight, [&](std::size_t plane) {
          const std::size_t at = static_cast<std::size_t>(n) + plane * kBlock;
          return std::pair(upper[at], lower[at]);
        });
        for (std::size_t phase = 0; phase < rows_.phase_count && !passed_over; ++phase) {
          const auto light = mix(rows_.phases[phase].before, [&](std::size_t plane) {
            return std::pair(here[plane], before_[row][plane]);
          });
          composite_pixel(light, pixels(row, phase, block) + n);
        }
        before_[row] = here;
      }
    }
  }

  /// (1 - weight) * first + weight * second, for all planes.
  template <typename PairOf>
  [[nodiscard]] Mixed mix(float weight, const PairOf& pair_of) const {
    Mixed light{};
    for (std::size_t plane = 0; plane < planes(); ++plane) {
      const auto [first, second] = pair_of(plane);
      light[plane] = (1 - weight) * first + weight * second;
    }
    return light;
  }

  void composite_pixel(const Mixed& light, float* pixel) const {
    const float depth = light[0] * slab_mm_;
    if (depth <= 0) return;
    float& opacity = pixel[rows_.slice->emissions * image_.plane_stride];
    const float through = 1 - opacity;
    const float absorbed = -std::expm1(-depth);  // without cancellation for thin slabs
    const float weight = through * slab_mm_ * (absorbed / depth);
    for (std::size_t plane = 1; plane < planes(); ++plane)
      pixel[(static_cast<std::int64_t>(plane) - 1) * image_.plane_stride] += weight * light[plane];
    opacity += through * absorbed;
  }

  const SheetRows& rows_;
  const ImageRows& image_;
  float slab_mm_, floor_;
  std::int64_t pair_;
  std::array<Mixed, SheetRows::kMaxRows> before_{};  // the voxel before
};

void composite(const SheetRows& rows, float slab_mm, float floor, const ImageRows& image) {
  for (std::int64_t pair = 0; pair < rows.pairs; ++pair)
    PairSplat(rows, slab_mm, floor, image, pair).composite();
}

void mix(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed) {
  for (std::size_t n = 0; n < floats; ++n) {
    const float of_a = a.light != nullptr ? a.weight * a.light[n] : 0;
    mixed[n] = b.light != nullptr ? of_a + b.weight * b.light[n] : of_a;
  }
}

}  // namespace

const SplatKernels& scalar_kernels() {
  static constexpr SplatKernels kKernels{"scalar", composite, mix};
  return kKernels;
}

}  // namespace splatlas
