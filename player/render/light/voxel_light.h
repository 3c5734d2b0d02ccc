// Normals of the voxels of a volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "format/content/unit_vector.h"
#include "player/render/light/grey_gradient.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

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
  std::optional<GreyGradient> grey_;   // none without grey values
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

}  // namespace splatlas
