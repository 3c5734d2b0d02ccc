// Spans of a frame, whole or in strips.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "player/render/sheets/spans/span_model.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Rows [first, last) of a slice; none at first.
struct RowRange {
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = 0;

  [[nodiscard]] bool empty() const { return first >= last; }
  void include(const RowRange& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
};

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
  /// Builds the spans of a strip, lit. Valid until the next call.
  using Build = std::function<const SpanModel&(const SheetStrip& strip)>;

  /// All spans. The model must outlive it.
  explicit SheetSpans(const SpanModel& all) : frame_(all) {}
  /// `frame`: a model without slices. `strips`: at least 1.
  SheetSpans(const SpanModel& frame, std::size_t strips, Build build)
      : frame_(frame), strips_(strips), build_(std::move(build)) {}

  /// Box, appearances and number of voxels of all spans. Its slices may be missing.
  [[nodiscard]] const SpanModel& frame() const { return frame_; }

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
  std::size_t strips_ = 1;
  Build build_;
};

}  // namespace splatlas
