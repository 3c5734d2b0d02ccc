#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "player/sheets/block_runs.h"
#include "player/sheets/splat_kernels.h"

namespace splatlas {
namespace {

/// Optical properties of one voxel of the interpolated row: extinction, then emissions.
using Mixed = std::array<float, 4>;

/// Splatting of the rows of pixels between one pair of voxel rows.
class PairSplat {
 public:
  PairSplat(const SheetRows& rows, float slab_mm, float termination_threshold, const ImageRows& image,
            std::int64_t pair)
      : rows_(rows),
        image_(image),
        slab_mm_(slab_mm),
        termination_threshold_(termination_threshold),
        pair_(pair) {}

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
  /// True if the block's pixels are opaque in all rows and phases.
  [[nodiscard]] bool opaque(std::int64_t block) const {
    for (std::size_t row = 0; row < rows_.rows_between; ++row) {
      for (std::size_t phase = 0; phase < rows_.phase_count; ++phase) {
        const float* opacity = pixels(row, phase, block) + rows_.slice->emissions * image_.plane_stride;
        if (!std::all_of(opacity, opacity + kBlock, [&](float o) { return o >= 1 - termination_threshold_; }))
          return false;
      }
    }
    return true;
  }

  void composite_block(const BlockRun& run, std::int64_t block) {
    const float* upper = run.upper.optics(block, rows_.slice->block_floats(), kEmptyBlock.data());
    const float* lower = run.lower.optics(block, rows_.slice->block_floats(), kEmptyBlock.data());
    const bool skipped = opaque(block);
    for (std::size_t row = 0; row < rows_.rows_between; ++row) {
      const float weight = rows_.lower_weights[row];
      for (std::int64_t n = 0; n < kBlock; ++n) {
        const auto here = mix(weight, [&](std::size_t plane) {
          const std::size_t at = static_cast<std::size_t>(n) + plane * kBlock;
          return std::pair(upper[at], lower[at]);
        });
        for (std::size_t phase = 0; phase < rows_.phase_count && !skipped; ++phase) {
          const auto optics = mix(rows_.phases[phase].before, [&](std::size_t plane) {
            return std::pair(here[plane], before_[row][plane]);
          });
          composite_pixel(optics, pixels(row, phase, block) + n);
        }
        before_[row] = here;
      }
    }
  }

  /// (1 - weight) * first + weight * second, for all planes.
  template <typename PairOf>
  [[nodiscard]] Mixed mix(float weight, const PairOf& pair_of) const {
    Mixed optics{};
    for (std::size_t plane = 0; plane < planes(); ++plane) {
      const auto [first, second] = pair_of(plane);
      optics[plane] = (1 - weight) * first + weight * second;
    }
    return optics;
  }

  void composite_pixel(const Mixed& optics, float* pixel) const {
    const float depth = optics[0] * slab_mm_;
    if (depth <= 0) return;
    float& opacity = pixel[rows_.slice->emissions * image_.plane_stride];
    const float transmittance = 1 - opacity;
    const float absorbed = -std::expm1(-depth);  // without cancellation for thin slabs
    const float weight = transmittance * slab_mm_ * (absorbed / depth);
    for (std::size_t plane = 1; plane < planes(); ++plane)
      pixel[(static_cast<std::int64_t>(plane) - 1) * image_.plane_stride] += weight * optics[plane];
    opacity += transmittance * absorbed;
  }

  const SheetRows& rows_;
  const ImageRows& image_;
  float slab_mm_, termination_threshold_;
  std::int64_t pair_;
  std::array<Mixed, SheetRows::kMaxRows> before_{};  // the previous voxel
};

void composite(const SheetRows& rows, float slab_mm, float termination_threshold, const ImageRows& image) {
  assert(rows.rows_between >= 1 && rows.rows_between <= SheetRows::kMaxRows);
  assert(rows.phase_count >= 1 && rows.phase_count <= SheetRows::kMaxPhases);
  for (std::int64_t pair = 0; pair < rows.pairs; ++pair)
    PairSplat(rows, slab_mm, termination_threshold, image, pair).composite();
}

void mix(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed) {
  for (std::size_t n = 0; n < floats; ++n) {
    const float of_a = a.optics != nullptr ? a.weight * a.optics[n] : 0;
    mixed[n] = b.optics != nullptr ? of_a + b.weight * b.optics[n] : of_a;
  }
}

}  // namespace

const SplatKernels& scalar_kernels() {
  static constexpr SplatKernels kKernels{"scalar", composite, mix};
  return kKernels;
}

}  // namespace splatlas
