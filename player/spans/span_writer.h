// From the light of a scanline's voxels to its spans.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "player/spans/span_model.h"

namespace splatlas {

/// Makes the spans of one slice, row by row: voxels get their light in a dense line, of which the blocks that
/// absorb anything are then kept. Cost: linear in the voxels that are set and the rows of the slice.
class SpanWriter {
 public:
  /// Voxels are in [scan_first, scan_first + scan_voxels). `out` is emptied; its memory is used again.
  SpanWriter(std::int64_t scan_first, std::int64_t scan_voxels, int emissions, SliceSpans& out);

  /// `count` voxels from `first` on, which follow those before: the caller sets their extinctions and then
  /// their emissions, 0 where there is no extinction.
  void add(std::uint32_t first, std::uint32_t count);
  [[nodiscard]] float* extinctions(std::uint32_t first) { return line_.data() + (first - origin_); }
  [[nodiscard]] float* emissions(std::uint32_t first, int n) {
    return extinctions(first) + (1 + n) * plane_floats_;
  }
  /// Makes colours of white emissions, of voxels that have the first emission only as yet.
  void color(std::uint32_t first, std::uint32_t count, const std::array<float, 3>& color);
  /// Some that have been added are shaded: by normals[0], normals[stride], ... Others are not.
  void shade(std::uint32_t first, std::uint32_t count, const PackedNormal* normals, std::size_t stride);
  /// Keeps the row; `row` is a number of the grid and grows from call to call.
  void end_row(std::int64_t row);
  /// After the last row.
  void finish();

 private:
  struct Blocks {
    std::uint32_t first = 0, last = 0;
  };
  struct ShadedRun {
    std::uint32_t first = 0, count = 0;
    const PackedNormal* normals = nullptr;
    std::size_t stride = 1;
  };
  void keep(std::uint32_t block, std::size_t first_of_row);
  void append(const float* line);
  void end_span(std::size_t first_of_row);
  void list(const ShadedRun& run, std::size_t first_of_row);

  SliceSpans& out_;
  std::uint32_t origin_;  // voxel that the line begins with, of a block
  std::int64_t plane_floats_;
  std::vector<float> line_;  // planes: extinction, emissions; zero outside `blocks_`
  std::vector<Blocks> blocks_;
  std::vector<ShadedRun> shaded_;
};

}  // namespace splatlas
