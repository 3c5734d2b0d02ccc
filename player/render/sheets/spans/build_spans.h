// Incremental construction of spans from selected runs; those of a frame, whole or in strips.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/transfer/volume_appearances.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Rows of a sheet, in voxels: v in [first, last].
struct SheetStrip {
  const Shear& shear;
  std::int64_t first = 0, last = 0;

  /// Voxel rows of a slice with footprints in the strip, in slabs up to a slice away.
  [[nodiscard]] RowRange rows_of(std::int64_t slice) const;
};

/// The spans of a frame: all at once or, if memory does not hold them, for one strip of the sheet at a time.
class SheetSpans {
 public:
  /// Builds the spans of a strip. Valid until the next call.
  using Build = std::function<const SpanModel&(const SheetStrip& strip)>;

  /// `frame` must outlive it: all spans or, with `build`, a model without slices. `factors`: light by packed
  /// normal, 65536; empty: unlit.
  explicit SheetSpans(const SpanModel& frame, std::vector<float> factors = {}, std::size_t strips = 1,
                      Build build = {})
      : frame_(frame), factors_(std::move(factors)), strips_(strips), build_(std::move(build)) {}

  /// Box, appearances and number of voxels of all spans. Its slices may be missing.
  [[nodiscard]] const SpanModel& frame() const { return frame_; }
  [[nodiscard]] std::span<const float> factors() const { return factors_; }

  /// Calls body(model, first, last) for the strips of a sheet: parts [first, last) of `parts` parts of
  /// `part_rows` rows, from v = v0 on.
  template <typename Body>
  void for_each_strip(const Shear& shear, std::int64_t v0, std::size_t parts, std::int64_t part_rows,
                      const Body& body) const {
    const std::size_t strips = build_ ? std::min(strips_, parts) : 1;
    for (std::size_t n = 0; n < strips; ++n) {
      const std::size_t first = parts * n / strips, last = parts * (n + 1) / strips;
      const auto v = [&](std::size_t part) { return v0 + static_cast<std::int64_t>(part) * part_rows; };
      body(build_ ? build_({shear, v(first), v(last)}) : frame_, first, last);
    }
  }

 private:
  const SpanModel& frame_;
  std::vector<float> factors_;
  std::size_t strips_;
  Build build_;
};

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
  bool shade = true;                               ///< list the lights of voxels
  std::optional<SheetStrip> strip = std::nullopt;  ///< of the voxels; none: all
};

/// A model without slices: the box and the appearances of a request.
[[nodiscard]] SpanModel empty_model(const SpanRequest& request);

/// Builder of the spans of successive selections, for one principal axis. Not thread-safe.
class SpanBuilder {
 public:
  /// Looks up the optical properties of every selected voxel (pre-classification) and packs them into spans.
  /// Voxels without extinction are omitted. Slices whose classes keep their appearance remain unchanged.
  /// Others keep the rows before and behind those that change. All requests must share one atlas, axis and
  /// VolumeAppearances, and have no strip; one with a strip needs a new builder. Cost: linear in the selected
  /// voxels and decoded runs of the changed rows, and a copy of the others of their slices. Slices are built
  /// in parallel. Throws std::bad_alloc.
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
                   SliceSpans& out) const;
  [[nodiscard]] std::size_t max_floats(const SpanRequest& request, std::int64_t slice,
                                       const RowRange& rows) const;

  SpanModel model_;
  OpticalArena arena_;  // of the model's optical properties
  ClassAppearances appearances_;
  std::int64_t rows_built_ = 0;
};

}  // namespace splatlas
