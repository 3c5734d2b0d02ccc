// Incremental construction of spans from selected runs.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/light/voxel_light.h"
#include "player/render/sheets/spans/sheet_spans.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

/// Sets the emissions, colour and mean extinction of a model. `appearances` are those of the plan's classes.
void set_appearances(const DrawPlan& plan, std::span<const VolumeAppearance> appearances,
                     const ClassTable& classes, SpanModel& model);

/// Input of SpanBuilder::build().
struct SpanRequest {
  const SelectedRuns& runs;
  const DrawPlan& plan;
  const VolumeAppearances& appearances;  ///< of the plan's classes
  const ClassTable& classes;
  const Grid& grid;
  const ClassCache& cache;
  bool shade = true;                               ///< list lit voxels for light_spans()
  std::optional<SheetStrip> strip = std::nullopt;  ///< of the voxels; none: all
};

/// A model without slices: the box and the appearances of a request.
[[nodiscard]] SpanModel empty_model(const SpanRequest& request);

/// Builder of the spans of successive selections, for one principal axis. Not thread-safe.
class SpanBuilder {
 public:
  /// Looks up the optical properties of every selected voxel (pre-classification) and packs them into spans.
  /// Voxels without extinction are omitted. Slices whose classes keep their appearance remain unchanged, with
  /// their shading. Others are no longer lit; they keep the rows before and behind those that change.
  /// All requests must share one atlas, axis and VolumeAppearances, and have no strip; one with a strip needs
  /// a new builder. Cost: linear in the selected voxels and decoded runs of the changed rows, and a copy of
  /// the others of their slices. Slices are built in parallel. Throws std::bad_alloc.
  void build(const SpanRequest& request, ThreadPool& pool);

  [[nodiscard]] const SpanModel& model() const { return model_; }
  [[nodiscard]] SpanModel& model() { return model_; }
  /// Number of rows of slices that the latest build() rebuilt.
  [[nodiscard]] std::int64_t rows_built() const { return rows_built_; }

 private:
  static constexpr std::uint32_t kNotDrawn = SelectedRuns::kNotDrawn;

  /// Appearance of the voxels of some classes.
  struct SpanAppearance {
    VolumeAppearance volume;
    bool boundary = false;
    friend bool operator==(const SpanAppearance&, const SpanAppearance&) = default;
  };
  /// Map from classes to appearances.
  struct ClassAppearances {
    std::vector<SpanAppearance> appearances;
    std::vector<std::uint32_t> of_class;  // index into `appearances`, or kNotDrawn
    std::uint64_t generation = 0;         // of the transfer functions
    bool shade = false;                   // list lit voxels

    [[nodiscard]] bool differ(const ClassAppearances& other, ClassId c) const;
  };
  [[nodiscard]] static ClassAppearances class_appearances(const SpanRequest& request, bool colored);
  [[nodiscard]] std::vector<RowRange> changed_rows(const SpanRequest& request, const SpanModel& before,
                                                   const ClassAppearances& appearances_before) const;
  [[nodiscard]] bool take_over(SpanModel& before);
  void write_slice(const SpanRequest& request, const RowRange& rows, const SliceSpans& before,
                   VoxelLighter& lighter, SliceSpans& out) const;
  [[nodiscard]] std::size_t max_floats(const SpanRequest& request, std::int64_t slice,
                                       const RowRange& rows) const;

  SpanModel model_;
  OpticalArena arena_;  // of the model's optical properties
  ClassAppearances appearances_;
  std::int64_t rows_built_ = 0;
};

}  // namespace splatlas
