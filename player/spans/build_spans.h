// From selected runs to spans, and from the spans of one selection to those of the next.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/system/thread_pool.h"
#include "player/spans/selected_runs.h"
#include "player/spans/span_model.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

/// Tells a model about the looks of a plan's volumes: colours and extinctions. `looks` and the plan's classes
/// correspond.
void set_appearances(const DrawPlan& plan, std::span<const VolumeAppearance> appearances,
                     const ClassTable& classes, SpanModel& model);

/// What spans are made from.
struct SpanRequest {
  const SelectedRuns& runs;
  const DrawPlan& plan;
  const VolumeAppearances& appearances;  ///< of the plan's classes
  const ClassTable& classes;
  const Grid& grid;
  const ClassCache& cache;
  bool shade = true;  ///< list boundary voxels for shade_spans()
};

/// The spans of one selection after another, for one principal axis. Not for use by several threads at once.
class SpanBuilder {
 public:
  /// Appearances up what every selected voxel emits and absorbs (classified before interpolation) and packs
  /// it into spans; voxels without extinction are left out. Slices in which no class looks otherwise than
  /// before are kept as they are, with their shading; others are unshaded. All requests must be of one atlas
  /// and axis, and of one VolumeAppearances. Cost: linear in the voxels of the slices that change, and in the
  /// runs there that are decoded; slices are built in parallel.
  void build(const SpanRequest& request, ThreadPool& pool);

  [[nodiscard]] const SpanModel& model() const { return model_; }
  [[nodiscard]] SpanModel& model() { return model_; }
  /// Slices that the latest build() has made anew.
  [[nodiscard]] std::size_t slices_built() const { return slices_built_; }
  /// Bytes of light, in use or kept for the next build().
  [[nodiscard]] std::uint64_t optical_bytes() const { return arena_.bytes(); }

 private:
  static constexpr std::uint32_t kNotDrawn = SelectedRuns::kNotDrawn;

  /// How the voxels of some classes are drawn.
  struct SpanAppearance {
    VolumeAppearance volume;
    bool shaded = false;
    friend bool operator==(const SpanAppearance&, const SpanAppearance&) = default;
  };
  /// Which class is drawn how.
  struct ClassAppearances {
    std::vector<SpanAppearance> appearances;
    std::vector<std::uint32_t> of_class;  // index into `looks`, or kNotDrawn
    std::uint64_t generation = 0;         // of the transfer functions

    [[nodiscard]] bool differ(const ClassAppearances& other, ClassId c) const;
  };
  [[nodiscard]] static ClassAppearances class_appearances(const SpanRequest& request, bool colored);
  [[nodiscard]] std::vector<bool> changed_slices(const SpanRequest& request, const SpanModel& before,
                                                 const ClassAppearances& appearances_before) const;
  void take_over(SpanModel& before, std::vector<bool>& changed);
  void write_slice(const SpanRequest& request, std::int64_t slice, SliceSpans& out) const;
  [[nodiscard]] std::size_t max_floats_of_slice() const;

  SpanModel model_;
  OpticalArena arena_;  // of the model's light
  ClassAppearances appearances_;
  std::size_t slices_built_ = 0;
};

}  // namespace splatlas
