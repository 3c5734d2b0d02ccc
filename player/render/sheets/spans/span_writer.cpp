#include "player/render/sheets/spans/span_writer.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include <hwy/cache_control.h>

namespace splatlas {
namespace {

constexpr std::array<float, 3> kWhite{1, 1, 1};

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
  out.lit.clear();
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
  plane_floats_ = static_cast<std::int64_t>(now);
}

void SpanWriter::color(std::uint32_t first, std::uint32_t count, const std::array<float, 3>& color,
                       const VoxelLight* lights, std::size_t stride) {
  float* const extinction = extinctions(first);
  const std::array<float, 3>& of_voxels = out_.emissions == 1 ? kWhite : color;
  if (out_.emissions == 3) {
    const float* const white = whites(first);
    for (std::int64_t c = 0; c < 3; ++c) {
      float* const colored = extinction + (1 + c) * plane_floats_;
      for (std::uint32_t n = 0; n < count; ++n) colored[n] = white[n] * color[static_cast<std::size_t>(c)];
    }
  }
  if (lights == nullptr) return;
  lit_.push_back(
      {first, count, static_cast<std::size_t>(extinction - line_.data()), of_voxels, lights, stride});
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
  std::size_t s = first_of_row;
  for (const Run& run : lit_) list(run, s);
  lit_.clear();
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
  std::vector<LitVoxel>& voxels = out_.lit.voxels;
  auto run = from.lit.runs.begin();
  for (std::int64_t row = first; row < std::min(last, from.last_row); ++row) {
    const std::size_t first_of_row = out_.spans.size();
    for (Span span : from.row(row)) {
      const std::size_t floats = span.blocks * block_floats;
      const auto offset = static_cast<std::uint32_t>(out_.optics.size() / block_floats);
      std::copy_n(from.optics.data() + span.offset * block_floats, floats, out_.optics.append(floats));
      const std::uint32_t lane = span.offset << kBlockBits, end = lane + (span.blocks << kBlockBits);
      for (; run != from.lit.runs.end() && run->number < end; ++run) {
        if (run->number < lane) continue;
        out_.lit.runs.push_back({run->number - lane + (offset << kBlockBits),
                                 static_cast<std::uint32_t>(voxels.size()), run->count, run->color});
        const auto lit = from.lit.voxels.begin() + run->first;
        voxels.insert(voxels.end(), lit, lit + run->count);
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

/// Lists the lit voxels of a run, block by block. `s`: the first span of the row that may hold them.
void SpanWriter::list(const Run& run, std::size_t& s) {
  const float* const whites = line_.data() + white_plane() * plane_floats_ + run.place;
  const std::vector<Span>& spans = out_.spans;
  std::vector<LitVoxel>& voxels = out_.lit.voxels;
  std::size_t size = voxels.size();
  voxels.resize(size + run.count);
  bool goes_on = false;
  const std::uint32_t end = run.first + run.count;
  for (std::uint32_t voxel = run.first; voxel < end;) {
    while (s < spans.size() && spans[s].first_block + spans[s].blocks <= block_of(voxel)) ++s;
    if (s == spans.size()) break;
    voxel = std::max(voxel, spans[s].first_block << kBlockBits);
    const std::uint32_t last = std::min(end, (block_of(voxel) + 1) << kBlockBits);
    std::uint32_t lane = SliceSpans::lane_of(spans[s], voxel);
    const float* const white =
        out_.emissions == 1 ? out_.optics.data() + out_.place(lane) + kBlock : whites + (voxel - run.first);
    for (std::uint32_t n = 0, of_run = voxel - run.first; voxel < last; ++n, ++of_run, ++voxel, ++lane) {
      const VoxelLight& light = run.lights[of_run * run.stride];
      const bool is_lit = light.lit > 0 && white[n] > 0;
      if (is_lit && !goes_on) out_.lit.begin_run(lane, size, run.color);
      goes_on = is_lit;
      if (!is_lit) continue;
      voxels[size++] = {white[n], light};
      ++out_.lit.runs.back().count;
    }
  }
  voxels.resize(size);
}

}  // namespace splatlas
