// Writer of the spans of a slice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "player/render/decode/lit_voxels.h"
#include "player/render/sheets/spans/span_model.h"

namespace splatlas {

/// Writes the spans of one slice, row by row. The caller fills a scanline buffer of the blocks with added
/// voxels; end_row() keeps those with positive extinction. Linear in the added voxels and the slice's rows.
class SpanWriter {
 public:
  /// `out` is cleared and keeps its capacity.
  SpanWriter(int emissions, SliceSpans& out);

  /// Adds `count` voxels from `first` on, in ascending order. The caller sets their extinctions and
  /// whites, and then color(), before the next add(). Without extinction they must be 0.
  void add(std::uint32_t first, std::uint32_t count);
  /// Extinctions of the latest voxels, from `first` on.
  [[nodiscard]] float* extinctions(std::uint32_t first) {
    const Blocks& latest = blocks_.back();
    return line_.data() + latest.place + (first - (latest.first << kBlockBits));
  }
  /// Emissions of white of the latest voxels, from `first` on.
  [[nodiscard]] float* whites(std::uint32_t first) {
    return extinctions(first) + white_plane() * plane_floats_;
  }
  /// Sets the emissions of some of the latest voxels to those of white times a colour, which volumes of one
  /// colour ignore, and lists the lit ones. `lights`, of voxels `stride` apart, must be valid until the end
  /// of the row; null: none is lit.
  void color(std::uint32_t first, std::uint32_t count, const std::array<float, 3>& color,
             const VoxelLight* lights = nullptr, std::size_t stride = 1);
  /// Appends the row's spans. Rows of the grid come in ascending order.
  void end_row(std::int64_t row);
  /// Appends rows [first, last) of another slice with the same emissions.
  void copy(const SliceSpans& from, std::int64_t first, std::int64_t last);
  /// Completes the offsets, after the last row.
  void finish();

 private:
  /// Consecutive blocks [first, last) of a row, from `place` on in every plane of the buffer.
  struct Blocks {
    std::uint32_t first = 0, last = 0;
    std::size_t place = 0;
    [[nodiscard]] std::size_t end() const { return place + (std::size_t{last - first} << kBlockBits); }
  };
  /// Voxels of a row that may be lit: [place, end) of every plane of the buffer.
  struct Run {
    std::size_t place = 0, end = 0;
  };
  /// Plane of the emissions of white: the only ones, or behind the three others.
  [[nodiscard]] std::int64_t white_plane() const { return out_.emissions == 1 ? 1 : 4; }
  void make_room(std::size_t floats);
  void keep(std::uint32_t block, float* line, std::size_t first_of_row);
  void append(const float* line);
  void end_span(std::size_t first_of_row);
  void list(std::size_t place);
  void list_row(std::int64_t row, std::size_t first_of_row);

  SliceSpans& out_;
  std::int64_t plane_floats_ = 0;
  // Planes: extinction, emissions, and the emission of white if there are three others. All but the last are
  // zero outside blocks_.
  std::vector<float> line_;
  std::vector<VoxelLight> lights_;  // another plane; set within lit_
  std::vector<Blocks> blocks_;
  std::vector<Run> lit_;
  std::size_t next_lit_ = 0;  // that may reach a block to keep
};

}  // namespace splatlas
