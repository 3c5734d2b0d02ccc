#include "bench/experiments/packed_spans.h"

#include <algorithm>
#include <vector>

#include "player/render/sheets/spans/span_writer.h"

namespace splatlas {
namespace {

/// One voxel: extinction, emissions.
using Planes = std::array<float, 4>;

std::vector<Planes> all_voxels(const SpanModel& model) {
  std::vector<Planes> voxels;
  voxels.reserve(static_cast<std::size_t>(model.voxels));
  for (const SliceSpans& slice : model.slices) {
    for (const Span& span : slice.spans) {
      for (std::uint32_t n = 0; n < span.blocks << kBlockBits; ++n) {
        const std::size_t place = slice.place(span, (span.first_block << kBlockBits) + n);
        if (slice.optics.data()[place] <= 0) continue;
        Planes& optics = voxels.emplace_back();
        for (std::size_t plane = 0; plane <= static_cast<std::size_t>(slice.emissions); ++plane)
          optics[plane] = slice.optics.data()[place + plane * kBlock];
      }
    }
  }
  return voxels;
}

/// Packs voxels from `first` on, row by row, as many as fit.
void pack_slice(const std::vector<Planes>& voxels, std::size_t first, const SpanModel& model,
                SliceSpans& slice) {
  SpanWriter writer(model.emissions, slice);
  for (std::int64_t row = 0; row < model.rows && first < voxels.size(); ++row) {
    const std::size_t count = std::min(voxels.size() - first, static_cast<std::size_t>(model.scan_voxels));
    writer.add(0, static_cast<std::uint32_t>(count));
    for (std::size_t n = 0; n < count; ++n) {
      writer.extinctions(0)[n] = voxels[first + n][0];
      for (int emission = 0; emission < model.emissions; ++emission)
        writer.emissions(0, emission)[n] = voxels[first + n][static_cast<std::size_t>(emission) + 1];
    }
    writer.end_row(row);
    first += count;
  }
  writer.finish();
}

}  // namespace

PackedSpans pack_spans(const SpanModel& model, const Shear& shear, const SheetWindow& window) {
  PackedSpans packed{{}, window, shear};
  packed.window.u0 = packed.window.v0 = 0;
  packed.shear.slope_u = packed.shear.slope_v = 0.01;
  packed.shear.k_ref = -50;  // slices are half a voxel off, with almost no shift between them
  SpanModel& into = packed.model;
  into.axis = model.axis;
  into.emissions = model.emissions;
  into.color = model.color;
  into.rows = std::max<std::int64_t>(window.rows - 1, 1);
  // The last voxel of a span must leave room for its footprint.
  into.scan_voxels = std::max<std::int64_t>(window.columns / kBlock * kBlock, kBlock) - 1;
  const std::vector<Planes> voxels = all_voxels(model);
  const auto per_slice = static_cast<std::size_t>(into.rows * into.scan_voxels);
  for (std::size_t first = 0; first < voxels.size(); first += per_slice) {
    into.slices.emplace_back().number = into.slice_count++;
    pack_slice(voxels, first, into, into.slices.back());
    into.voxels += into.slices.back().voxels;
  }
  return packed;
}

}  // namespace splatlas
