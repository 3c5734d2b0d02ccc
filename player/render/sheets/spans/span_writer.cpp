#include "player/render/sheets/spans/span_writer.h"

#include <algorithm>
#include <cstring>
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
  out.shaded.clear();
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
  const std::size_t planes = 1 + static_cast<std::size_t>(out_.emissions);
  std::vector<float> line(now * planes);
  for (std::size_t plane = 0; plane < planes; ++plane)
    std::copy_n(line_.data() + plane * before, before, line.data() + plane * now);
  line_ = std::move(line);
  plane_floats_ = static_cast<std::int64_t>(now);
}

void SpanWriter::color(std::uint32_t first, std::uint32_t count, const std::array<float, 3>& color) {
  const float* const white = emissions(first, 0);
  for (const int c : {2, 1, 0}) {
    float* const colored = emissions(first, c);
    for (std::uint32_t n = 0; n < count; ++n) colored[n] = white[n] * color[static_cast<std::size_t>(c)];
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
  for (const ShadedRun& run : shaded_) list(run, first_of_row);
  shaded_.clear();
  if (out_.spans.size() == first_of_row) return;
  if (out_.first_span.empty()) out_.first_row = row;
  out_.first_span.resize(static_cast<std::size_t>(row - out_.first_row) + 1,
                         static_cast<std::uint32_t>(first_of_row));
  out_.last_row = row + 1;
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

void SpanWriter::list(const ShadedRun& run, std::size_t first_of_row) {
  std::size_t s = first_of_row;
  for (std::uint32_t n = 0; n < run.count; ++n) {
    const std::uint16_t lit = run.light.lit == nullptr ? ShadedVoxel::kAllLit : run.light.lit[n];
    if (lit == 0) continue;
    const std::uint32_t voxel = run.first + n;
    while (s < out_.spans.size() && block_of(voxel) >= out_.spans[s].first_block + out_.spans[s].blocks) ++s;
    if (s == out_.spans.size()) return;
    if (block_of(voxel) < out_.spans[s].first_block) continue;
    ShadedVoxel shaded{out_.place(out_.spans[s], voxel), run.light.normals[n * run.light.stride], lit, {}};
    const float* const optics = out_.optics.data() + shaded.place;
    if (optics[0] <= 0) continue;
    for (int c = 0; c < out_.emissions; ++c)
      shaded.emission[static_cast<std::size_t>(c)] = optics[(c + 1) * kBlock];
    out_.shaded.push_back(shaded);
  }
}

}  // namespace splatlas
