// Spans of blocks of voxels, for first pictures.
#pragma once

#include <memory>
#include <optional>

#include "format/content/selection.h"
#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/decode/block_volume.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/transfer/shading.h"

namespace splatlas {

/// Spans of a BlockVolume: its optical properties, times the share of each block that the selection fills.
/// Not thread-safe.
class BlockSpans {
 public:
  /// `selection` is that of the volume's plan.
  BlockSpans(std::unique_ptr<BlockVolume> volume, const Selection& selection, const Atlas& atlas);

  /// Builds the spans along an axis unless they exist, and applies the lighting of `view`; `shade`: hybrid
  /// shading. Throws std::bad_alloc.
  void prepare(Axis axis, bool shade, const ParallelView& view, const Lighting& lighting, ThreadPool& pool);

  [[nodiscard]] const SpanModel& model() const { return spans_->model(); }
  [[nodiscard]] const Grid& grid() const { return volume_->grid(); }

 private:
  void scale_by_shares(SpanModel& spans, ThreadPool& pool) const;

  std::unique_ptr<BlockVolume> volume_;
  VolumeAppearances appearances_;
  std::optional<SpanBuilder> spans_;
  bool shaded_ = false;
  std::optional<ParallelView> lit_for_;
};

}  // namespace splatlas
