// Normals of the voxels of a volume, gradients of their grey values, and their kernels; sums over the voxels
// of a block, for the means of drafts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "format/content/grid.h"
#include "format/content/unit_vector.h"
#include "player/render/decode/class_cache.h"
#include "player/render/decode/lit_voxels.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/transfer/shading.h"
#include "player/render/transfer/transfer_table.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

/// Kernels process whole vectors of at most as many lanes.
inline constexpr std::size_t kLightPadding = 16;

/// Nine rows of voxels, (slice - 1) * 3 + (row - 1), from one position on. One more is readable before.
struct GreyRows {
  std::array<const float*, 9> values;    ///< 0 where not selected
  std::array<const float*, 9> selected;  ///< 0 or 1
};

/// Weighted sums over pairs of neighbours along an axis, by position.
struct PairSums {
  float *pairs, *differences, *squares;
};

/// Units of gradients.
struct GradientScale {
  std::array<std::array<float, 3>, 3> to_lps{};  ///< of those along the scanline, the rows and the slices
  std::array<float, 3> per_mm_squared{};         ///< along them
  float reach_mm = 0;
};

/// Gradients of a row of voxels.
struct GradientRow {
  std::array<float*, 3> direction;  ///< in LPS, of any length
  float* coherence;                 ///< 0 for noise to 1
  float* reach;                     ///< change of the grey value over the reach
};

/// Normals of a row of voxels, and their lit shares.
struct LitRow {
  PackedNormal* normals;
  std::uint16_t* lit;
};

struct LightKernels {
  /// The weighted means of the differences of pairs of selected voxels in the 3x3x3 voxels around each one.
  /// `sums`: three axes, of `count` + 2 positions; overwritten.
  void (*gradient)(const GreyRows& rows, std::size_t count, const GradientScale& scale,
                   const std::array<PairSums, 3>& sums, const GradientRow& out);
  /// Voxels at borders: replaces the label's normal by the gradient as far as both have one direction.
  void (*boundary)(const PackedNormal* labels, std::size_t count, const GradientRow& gradients,
                   const LitRow& out);
  /// Extinctions below and above grey values, by their reach. Linear between whole numbers.
  void (*extinctions)(const TransferTable::View& table, const float* greys, const float* reach,
                      std::size_t count, float* below, float* above);
  /// Others: lit where the extinctions below and above the grey value, by its reach, differ.
  void (*interior)(const float* below, const float* above, std::size_t count, const GradientRow& gradients,
                   const LitRow& out);
};

/// For the best instruction set of the machine, with equal bits on all.
[[nodiscard]] LightKernels light_kernels();

/// Gradients of grey values, from selected voxels alone (docs/model.md, "Hybrid shading"): along each axis of
/// the grid the weighted mean of the differences of all pairs of adjacent selected voxels in the block of
/// 3x3x3 around a voxel. Exact for linear ramps, also at the selection's border. Not thread-safe.
class GreyGradient {
 public:
  /// `runs` and `cache` must outlive this object. The atlas must have values.
  GreyGradient(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid,
               const GradientScale& scale);

  /// Computes the gradients of a row of a slice, both of the traversal. Cost: about 10 ns per selected voxel
  /// and voxel of small gaps. Following slices share what they have read.
  void set_row(std::int64_t slice, std::int64_t row);

  /// Those of the selected voxels of the row, from position `scan` in the scanline on.
  [[nodiscard]] GradientRow at(std::int64_t scan) { return row_from(scan - scan_first_); }
  /// Their grey values.
  [[nodiscard]] const float* greys(std::int64_t scan) const {
    return planes_[1].values.data() + row_ * width_ + 1 + (scan - scan_first_);
  }

 private:
  /// Padded positions [begin, end) of selected voxels with small gaps.
  struct Segment {
    std::int64_t begin = 0, end = 0;
  };
  /// The voxels of a slice of the box, padded by one voxel.
  struct Plane {
    std::int64_t slice = std::numeric_limits<std::int64_t>::min();
    std::vector<Segment> segments;           // by row
    std::vector<std::size_t> first_segment;  // of each row, and their number
    std::vector<float> values, selected;     // 0 or 1; values are 0 where `selected` is
  };
  void set_slice(std::int64_t slice);
  void fill(std::int64_t slice, Plane& plane) const;
  void measure(const Segment& segment);
  [[nodiscard]] GradientRow row_from(std::int64_t voxel) {
    const auto from = [voxel](std::vector<float>& row) { return row.data() + voxel; };
    return {{from(direction_[0]), from(direction_[1]), from(direction_[2])}, from(coherence_), from(reach_)};
  }

  const SelectedRuns& runs_;
  const ClassCache& cache_;
  std::array<std::size_t, 3> step_{};  // in memory, along the scanline, the rows and the slices
  GradientScale scale_;
  LightKernels kernels_ = light_kernels();
  std::int64_t scan_first_, row_first_, width_, height_;
  std::array<Plane, 3> planes_;             // before, at and after the slice
  std::array<std::vector<float>, 9> sums_;  // three of each axis
  std::array<std::vector<float>, 3> direction_;
  std::vector<float> coherence_, reach_;
  std::int64_t row_ = 0;  // padded
};

/// Normals of consecutive voxels of a scanline: normals[0], normals[stride], ...
struct VoxelLight {
  const PackedNormal* normals = nullptr;  ///< null: unlit
  std::size_t stride = 1;
  const std::uint16_t* lit =
      nullptr;  ///< shares of the emissions that depend on the normals, of 65535; null: all
};

/// Lights the voxels of a selection by the gradient of their grey values and by the normals of their
/// structures' borders (docs/model.md, "Hybrid shading"). Not thread-safe.
class VoxelLighter {
 public:
  /// Arguments must outlive this object. `shade`: false lights nothing.
  VoxelLighter(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid, bool shade);

  /// Lights `count` selected voxels of a row of a slice, all at borders or all inside of structures with this
  /// appearance. Valid until the next row. Cost: 15 ns per voxel with greys; see GreyGradient::set_row().
  [[nodiscard]] VoxelLight light(const VolumeAppearance& appearance, bool boundary, std::int64_t slice,
                                 std::int64_t row, std::uint32_t first, std::uint32_t count);

 private:
  /// Sets the extinctions of transfer functions around grey values.
  void find_extinctions(const TransferTable& transfer, const float* greys, const GradientRow& gradients,
                        std::size_t count);

  const PackedNormal* label_normals_;
  bool shade_;
  std::optional<GreyGradient> grey_;  // none without grey values
  LightKernels kernels_ = light_kernels();
  std::array<std::size_t, 3> step_{};  // in memory, along the scanline, the rows and the slices
  std::int64_t slice_ = -1, row_ = -1, scan_first_;
  // Of the current row
  std::vector<PackedNormal> labels_, normals_;
  std::vector<std::uint16_t> lit_;
  std::vector<float> below_, above_;  // extinctions around the grey values
};

/// Lighters for parallel tasks, which pass on their memory. Arguments as for VoxelLighter.
class VoxelLighters {
 public:
  VoxelLighters(const SelectedRuns& runs, const ClassCache& cache, const Grid& grid, bool shade)
      : make_([&runs, &cache, &grid, shade] {
          return std::make_unique<VoxelLighter>(runs, cache, grid, shade);
        }) {}

  /// Calls use(lighter) with a lighter that no other thread uses. Thread-safe.
  template <typename Use>
  void with(const Use& use) {
    std::unique_ptr<VoxelLighter> lighter;
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        lighter = std::move(free_.back());
        free_.pop_back();
      }
    }
    if (!lighter) lighter = make_();
    use(*lighter);
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(lighter));
  }

 private:
  std::function<std::unique_ptr<VoxelLighter>()> make_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<VoxelLighter>> free_;
};

/// Sums of optical properties of voxels (1/mm), and of their normals, weighted by the emission they light.
struct VoxelSums {
  float extinction = 0;
  std::array<float, 3> emission{};
  float weight = 0, lit = 0;  ///< of the emission: all of it, and its lit part
  std::array<float, 3> normal{};

  /// Adds a voxel, weighted by its emission. `lit`: null unless it is lit.
  void add(float of_extinction, const std::array<float, 3>& of_emission, const LitVoxel* of_lit,
           const UnpackedNormals& unpacked) {
    const float of_weight = of_emission[0] + of_emission[1] + of_emission[2];
    extinction += of_extinction;
    weight += of_weight;
    for (std::size_t c = 0; c < 3; ++c) emission[c] += of_emission[c];
    if (of_lit != nullptr)
      add_light(of_weight * static_cast<float>(of_lit->lit) / LitVoxel::kAllLit, of_lit->normal, unpacked);
  }
  /// Adds the lit emission of a voxel, in the unit of `weight`.
  void add_light(float emission_lit, PackedNormal of_voxel, const UnpackedNormals& unpacked) {
    lit += emission_lit;
    normal[0] += emission_lit * unpacked.x[of_voxel];
    normal[1] += emission_lit * unpacked.y[of_voxel];
    normal[2] += emission_lit * unpacked.z[of_voxel];
  }
  /// The colour whose product with the weight is the emission.
  [[nodiscard]] std::array<float, 3> color() const {
    if (weight <= 0) return {};
    return {emission[0] / weight, emission[1] / weight, emission[2] / weight};
  }
  /// Share of the emission that is lit, as LitVoxel::lit.
  [[nodiscard]] std::uint16_t lit_share() const {
    const float share = weight > 0 ? std::min(lit / weight, 1.0f) : 0;
    return static_cast<std::uint16_t>(std::lround(share * LitVoxel::kAllLit));
  }
};

}  // namespace splatlas
