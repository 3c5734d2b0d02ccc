// What rays march through: the selected voxels' grey values, or their light, in a box of their own.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "format/atlas_reader.h"
#include "format/decision_tree.h"
#include "format/selection.h"
#include "format/system/thread_pool.h"
#include "player/rays/march_kernels.h"
#include "player/render_options.h"
#include "player/spans/class_cache.h"
#include "player/spans/selected_runs.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

/// What a ray volume is made of. References must outlive the call that takes it.
struct RayVolumeRequest {
  const Atlas& atlas;
  const Selection& selection;
  const DrawPlan& plan;
  std::span<const VolumeAppearance> appearances;  ///< of the plan's classes
  const SelectedRuns& runs;                       ///< of the z axis
  const ClassCache& cache;
  Classification classification = Classification::kBefore;
  bool shade = false;  ///< boundary voxels can be lit by their normals
  std::uint64_t max_memory_bytes = 0;
};

/// The sources of a selection. Classes with the same transfer function are one source: their grey values are
/// interpolated together, what is not one of them counts as not there, and so are their colours, each voxel's
/// with its weight. Structures that cannot be classified after interpolation (grey_scale()) are classified
/// before it, all together.
class RayVolume {
 public:
  /// kLimit when it would take more memory than allowed, there are more than kMaxSources different transfer
  /// functions, or the box has more than 2^31 voxels. Cost: linear in the selected voxels and in the bricks
  /// of their box; nothing of an unselected class is read.
  [[nodiscard]] static Result<RayVolume> build(const RayVolumeRequest& request, ThreadPool& pool);

  /// Multiplies the colours of boundary voxels by `light[normal]` (65536 entries): once per change of view.
  void shade(std::span<const float> light, ThreadPool& pool);

  /// Nothing to march through.
  [[nodiscard]] bool empty() const { return sources_.empty(); }
  /// Voxel of the grid that position (0, 0, 0) is at.
  [[nodiscard]] const Index3& first() const { return first_; }
  [[nodiscard]] const MarchGrid& grid() const { return grid_; }
  [[nodiscard]] std::span<const MarchSource> sources() const { return views_; }
  /// Bricks in which any source shows something, as MarchSource::active.
  [[nodiscard]] const std::uint32_t* active() const { return active_.data(); }
  [[nodiscard]] std::uint64_t voxels() const { return voxels_; }
  [[nodiscard]] bool shaded() const { return shaded_voxels_ > 0; }

 private:
  /// A voxel whose colour depends on the view.
  struct ShadedVoxel {
    std::size_t place = 0;  // of its first of four values
    PackedNormal normal = 0;
    std::array<float, 3> color{};  // unshaded
  };
  struct Source {
    std::unique_ptr<PreintegratedTransfer> curve;  // none: light
    GreyScale scale;
    std::vector<bool> draws;  // classes of the plan that belong to it
    std::array<float, 3> color{};
    bool many_colors = false;
    SparseBytes values, colors;
    std::vector<std::uint32_t> active;
    std::vector<std::vector<ShadedVoxel>> shaded;  // by slice
  };
  class Builder;

  Index3 first_{};
  MarchGrid grid_;
  std::vector<Source> sources_;
  std::vector<MarchSource> views_;
  std::vector<std::uint32_t> active_;
  std::uint64_t voxels_ = 0, shaded_voxels_ = 0;
};

}  // namespace splatlas
