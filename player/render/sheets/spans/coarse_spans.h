// Spans of a coarser grid, for drafts.
#pragma once

#include <optional>

#include "format/content/grid.h"
#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/sheets/spans/build_spans.h"
#include "player/render/sheets/spans/optical_buffer.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/transfer/shading.h"

namespace splatlas {

/// Spans of a downsampled selection: for each block the average of the optical properties of its voxels, and
/// of their normals, weighted by emission. Not thread-safe.
class CoarseSpans {
 public:
  /// Builds the spans, unshaded, in parallel. They take no more memory than those of the voxels. `fine`: the
  /// spans of the voxels, with the same request; null if there are none. Cost: linear in the selected voxels,
  /// about 10 ns each with their spans and 150 ns without, and in the blocks of their box. Throws
  /// std::bad_alloc.
  CoarseSpans(const SpanRequest& request, const SpanModel* fine, int level, ThreadPool& pool);

  /// Hybrid shading: applies the lighting of `view` to boundary voxels if it has changed.
  void light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool);

  /// True for spans along `axis` of this level; `shade`: of a request that lists boundary voxels.
  [[nodiscard]] bool fit(Axis axis, int level, bool shade) const {
    return model_.axis == axis && level_ == level && shaded_ == shade;
  }
  [[nodiscard]] const SpanModel& model() const { return model_; }

 private:
  int level_;
  bool shaded_;
  OpticalArena arena_;  // of the model
  SpanModel model_;
  std::optional<ParallelView> lit_for_;
};

}  // namespace splatlas
