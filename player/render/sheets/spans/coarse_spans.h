// Spans of a coarser grid, and of blocks of voxels, for drafts.
#pragma once

#include <memory>
#include <optional>

#include "format/content/grid.h"
#include "format/content/selection.h"
#include "format/tasks/thread_pool.h"
#include "player/render/decode/block_volume.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/sheets/spans/span_model.h"

namespace splatlas {

/// Spans of a downsampled selection: for each block the average of the optical properties of its voxels, and
/// of their normals, weighted by emission. Not thread-safe.
class CoarseSpans {
 public:
  /// Builds the spans, in parallel, from those of the voxels. `shade`: list lights, of a model that lists
  /// those of voxels. Cost: 10 ns per voxel, and linear in the blocks of the box. Throws std::bad_alloc.
  CoarseSpans(const SpanModel& fine, bool shade, int level, ThreadPool& pool);

  /// True for spans along `axis` of this level; `shade`: those that list lights.
  [[nodiscard]] bool fit(Axis axis, int level, bool shade) const {
    return model_.axis == axis && level_ == level && shaded_ == shade;
  }
  [[nodiscard]] const SpanModel& model() const { return model_; }

 private:
  int level_;
  bool shaded_;
  OpticalArena arena_;  // of the model
  SpanModel model_;
};

/// Spans of a BlockVolume: its optics, times the share of each block that is selected. Not thread-safe.
class BlockSpans {
 public:
  /// `selection` is that of the volume's plan.
  BlockSpans(std::unique_ptr<BlockVolume> volume, const Selection& selection, const Atlas& atlas);

  /// Builds the spans along an axis unless they exist. `shade`: list lights. Throws std::bad_alloc.
  void prepare(Axis axis, bool shade, ThreadPool& pool);

  [[nodiscard]] const SpanModel& model() const { return spans_->model(); }
  [[nodiscard]] const Grid& grid() const { return volume_->grid(); }

 private:
  void scale_by_shares(SpanModel& spans, ThreadPool& pool) const;

  std::unique_ptr<BlockVolume> volume_;
  VolumeAppearances appearances_;
  std::optional<SpanBuilder> spans_;
  bool shaded_ = false;
};

}  // namespace splatlas
