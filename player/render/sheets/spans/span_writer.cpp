#include "player/render/sheets/spans/span_writer.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include <hwy/cache_control.h>

namespace splatlas {
namespace {

std::uint32_t block_of(std::int64_t voxel) {
  return static_cast<std::uint32_t>(voxel >> kBlockBits);
}

/// Number of voxels of a block with positive extinction.
std::uint32_t count_absorbing(const float* extinctions) {
  std::uint32_t absorbing = 0;
  for (std::int64_t n = 0; n < kBlock; ++n) absorbing += extinctions[n] > 0 ? 1 : 0;
  return absorbing;
}

}  // namespace

SpanWriter::SpanWriter(int emissions, SliceSpans& out) : out_(out) {
  out.emissions = emissions;
  out.first_row = out.last_row = 0;
  out.first_span.clear();
  out.spans.clear();
  out.optics.clear();
  out.lights.clear();
  out.voxels = 0;
}

void SpanWriter::add(std::uint32_t first, std::uint32_t count) {
  const std::uint32_t first_block = block_of(first), last_block = block_of(first + count - 1) + 1;
  if (!blocks_.empty() && first_block <= blocks_.back().last) {
    blocks_.back().last = last_block;
  } else {
    blocks_.push_back({first_block, last_block, blocks_.empty() ? 0 : blocks_.back().end()});
  }
  make_room(blocks_.back().end());
}

/// Extends every plane of the scanline buffer to `floats`.
void SpanWriter::make_room(std::size_t floats) {
  const auto before = static_cast<std::size_t>(plane_floats_);
  if (floats <= before) return;
  const std::size_t now = std::max({floats, 2 * before, std::size_t{512}});
  const auto planes = static_cast<std::size_t>(white_plane() + 1);
  std::vector<float> line(now * planes);
  for (std::size_t plane = 0; plane < planes; ++plane)
    std::copy_n(line_.data() + plane * before, before, line.data() + plane * now);
  line_ = std::move(line);
  lights_.resize(now);
  plane_floats_ = static_cast<std::int64_t>(now);
}

void SpanWriter::color(std::uint32_t first, std::uint32_t count, const std::array<float, 3>& color,
                       const VoxelLight* lights, std::size_t stride) {
  float* const extinction = extinctions(first);
  if (out_.emissions == 3) {
    const float* const white = whites(first);
    for (std::int64_t c = 0; c < 3; ++c) {
      float* const colored = extinction + (1 + c) * plane_floats_;
      for (std::uint32_t n = 0; n < count; ++n) colored[n] = white[n] * color[static_cast<std::size_t>(c)];
    }
  }
  if (lights == nullptr) return;
  const auto place = static_cast<std::size_t>(extinction - line_.data());
  for (std::uint32_t n = 0; n < count; ++n) lights_[place + n] = lights[n * stride];
  if (!lit_.empty() && lit_.back().end == place) {
    lit_.back().end += count;
  } else {
    lit_.push_back({place, place + count});
  }
}

void SpanWriter::end_row(std::int64_t row) {
  const std::size_t first_of_row = out_.spans.size();
  for (const Blocks& blocks : blocks_) {
    float* line = line_.data() + blocks.place;
    for (std::uint32_t block = blocks.first; block < blocks.last; ++block, line += kBlock)
      keep(block, line, first_of_row);
  }
  blocks_.clear();
  end_span(first_of_row);
  lit_.clear();
  next_lit_ = 0;
  list_row(row, first_of_row);
}

/// Sets the offsets of the latest row.
void SpanWriter::list_row(std::int64_t row, std::size_t first_of_row) {
  if (out_.spans.size() == first_of_row) return;
  if (out_.first_span.empty()) out_.first_row = row;
  out_.first_span.resize(static_cast<std::size_t>(row - out_.first_row) + 1,
                         static_cast<std::uint32_t>(first_of_row));
  out_.last_row = row + 1;
}

void SpanWriter::copy(const SliceSpans& from, std::int64_t first, std::int64_t last) {
  const auto block_floats = static_cast<std::size_t>(out_.block_floats());
  auto lights = from.lights.begin();
  for (std::int64_t row = first; row < std::min(last, from.last_row); ++row) {
    const std::size_t first_of_row = out_.spans.size();
    for (Span span : from.row(row)) {
      const std::size_t floats = span.blocks * block_floats;
      const auto offset = static_cast<std::uint32_t>(out_.optics.size() / block_floats);
      std::copy_n(from.optics.data() + span.offset * block_floats, floats, out_.optics.append(floats));
      for (; lights != from.lights.end() && lights->block < span.offset + span.blocks; ++lights) {
        if (lights->block < span.offset) continue;
        out_.lights.push_back(*lights);
        out_.lights.back().block += offset - span.offset;
      }
      span.offset = offset;
      out_.spans.push_back(span);
      out_.voxels += span.voxels;
    }
    list_row(row, first_of_row);
  }
}

void SpanWriter::finish() {
  if (!out_.spans.empty()) out_.first_span.push_back(static_cast<std::uint32_t>(out_.spans.size()));
}

/// Appends a block of the scanline buffer unless it is transparent, and clears it.
void SpanWriter::keep(std::uint32_t block, float* line, std::size_t first_of_row) {
  const std::uint32_t absorbing = count_absorbing(line);
  if (absorbing == 0) return;
  std::vector<Span>& spans = out_.spans;
  const auto reaches = [&] {
    return spans.size() > first_of_row && spans.back().first_block + spans.back().blocks == block;
  };
  if (!reaches()) {
    end_span(first_of_row);
    if (!reaches()) {
      const std::size_t floats = out_.optics.size() / static_cast<std::size_t>(out_.block_floats());
      spans.push_back({block, 0, 0, static_cast<std::uint32_t>(floats)});
    }
  }
  list(static_cast<std::size_t>(line - line_.data()));
  append(line);
  ++spans.back().blocks;
  spans.back().voxels += absorbing;
  out_.voxels += absorbing;
  for (int plane = 0; plane <= out_.emissions; ++plane)
    std::fill_n(line + plane * plane_floats_, kBlock, 0.0f);
}

void SpanWriter::append(const float* line) {
  float* const optics = out_.optics.append(static_cast<std::size_t>(out_.block_floats()));
  for (int plane = 0; plane <= out_.emissions; ++plane)  // memcpy of constant size compiles inline
    std::memcpy(optics + plane * kBlock, line + plane * plane_floats_, kBlock * sizeof(float));
}

/// Appends an empty block if the footprint of the last voxel reaches it.
void SpanWriter::end_span(std::size_t first_of_row) {
  if (out_.spans.size() == first_of_row) return;
  const auto block_floats = static_cast<std::size_t>(out_.block_floats());
  const float* const last = out_.optics.data() + (out_.optics.size() - block_floats);
  if (last[kBlock - 1] <= 0) return;
  std::fill_n(out_.optics.append(block_floats), block_floats, 0.0f);
  ++out_.spans.back().blocks;
}

/// Lists the lit voxels of the block at this place of the buffer, which is kept next.
void SpanWriter::list(std::size_t place) {
  while (next_lit_ < lit_.size() && lit_[next_lit_].end <= place) ++next_lit_;
  const auto block =
      static_cast<std::uint32_t>(out_.optics.size() / static_cast<std::size_t>(out_.block_floats()));
  for (std::size_t n = next_lit_; n < lit_.size() && lit_[n].place < place + kBlock; ++n) {
    const std::size_t begin = std::max(lit_[n].place, place),
                      end = std::min<std::size_t>(lit_[n].end, place + kBlock);
    const std::span<const VoxelLight> lights(lights_.data() + begin, end - begin);
    if (std::ranges::none_of(lights, [](const VoxelLight& light) { return light.lit > 0; })) continue;
    if (out_.lights.empty() || out_.lights.back().block != block) out_.lights.emplace_back().block = block;
    std::copy(lights.begin(), lights.end(), out_.lights.back().lights.data() + (begin - place));
  }
}

}  // namespace splatlas
