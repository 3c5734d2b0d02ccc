// Writer of the spans of a slice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "player/spans/span_model.h"

namespace splatlas {

/// Writes the spans of one slice, row by row. The caller fills a dense scanline buffer with optical
/// properties; end_row() keeps the blocks with positive extinction. Cost: linear in the added voxels and the
/// rows of the slice.
class SpanWriter {
 public:
  /// Voxels are in [scan_first, scan_first + scan_voxels). `out` is cleared and keeps its capacity.
  SpanWriter(std::int64_t scan_first, std::int64_t scan_voxels, int emissions, SliceSpans& out);

  /// Adds `count` voxels from `first` on, in ascending order. The caller sets their extinctions and
  /// emissions; the emission of a voxel without extinction must be 0.
  void add(std::uint32_t first, std::uint32_t count);
  [[nodiscard]] float* extinctions(std::uint32_t first) { return line_.data() + (first - origin_); }
  [[nodiscard]] float* emissions(std::uint32_t first, int n) {
    return extinctions(first) + (1 + n) * plane_floats_;
  }
  /// Multiplies emission 0, that of white, by a colour to get all three emissions.
  void color(std::uint32_t first, std::uint32_t count, const std::array<float, 3>& color);
  /// Lists added voxels as shaded, with normals[0], normals[stride], ...
  void shade(std::uint32_t first, std::uint32_t count, const PackedNormal* normals, std::size_t stride);
  /// Appends the row's spans. Rows of the grid come in ascending order.
  void end_row(std::int64_t row);
  /// Completes the offsets, after the last row.
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
  std::uint32_t origin_;  // first voxel of line_, at a block boundary
  std::int64_t plane_floats_;
  std::vector<float> line_;  // planes: extinction, emissions; zero outside blocks_
  std::vector<Blocks> blocks_;
  std::vector<ShadedRun> shaded_;
};

}  // namespace splatlas
