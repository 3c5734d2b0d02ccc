#include "player/span_model.h"

#include <algorithm>

namespace splatlas {
namespace {

/// What stays the same for every slice of a model.
struct BuildContext {
  const SelectedRuns& selected;
  const DrawPlan& plan;
  std::span<const VolumeLook> looks;
  const ClassCache& cache;
  bool shade;
  /// Memory steps of the grid, in voxels.
  std::size_t slice_stride, row_stride, scan_stride;

  [[nodiscard]] std::size_t voxel(std::int64_t slice, std::int64_t row, std::uint32_t start) const {
    return static_cast<std::size_t>(slice) * slice_stride + static_cast<std::size_t>(row) * row_stride +
           start * scan_stride;
  }
};

std::size_t padded(std::size_t length) {
  return (length + kSpanPadding) / kSpanPadding * kSpanPadding;
}

/// Appends the spans of one scanline: voxels with an extinction, gaps of up to kMaxSpanGap bridged.
/// `voxels` holds the looks of the scanline's runs, run after run.
void cut_spans(std::span<const SelectedRun> runs, const VoxelLook* voxels, SliceSpans& out) {
  const std::size_t first_of_row = out.spans.size();
  for (const SelectedRun& run : runs) {
    for (std::uint32_t n = 0; n < run.length; ++n) {
      if (voxels[n].extinction_per_mm <= 0) continue;
      const std::uint32_t at = run.start + n;
      ++out.voxels;
      if (out.spans.size() > first_of_row &&
          at - (out.spans.back().start + out.spans.back().length) <= kMaxSpanGap) {
        out.spans.back().length = at + 1 - out.spans.back().start;
        ++out.spans.back().voxels;
      } else {
        out.spans.push_back({at, 1, 1, 0});
      }
    }
    voxels += run.length;
  }
  for (std::size_t n = first_of_row; n < out.spans.size(); ++n) {
    out.spans[n].offset = out.plane_floats;
    out.plane_floats += padded(out.spans[n].length);
  }
}

/// Writes the light of one scanline into the planes of its spans.
void pack_spans(const BuildContext& context, std::int64_t slice, std::int64_t row,
                std::span<const SelectedRun> runs, const VoxelLook* voxels, std::span<const Span> spans,
                SliceSpans& out) {
  std::size_t s = 0;
  for (const SelectedRun& run : runs) {
    const VolumeLook& look = context.looks[run.draw];
    const bool shaded = context.shade && context.plan.classes[run.draw].boundary;
    const std::size_t first_voxel = context.voxel(slice, row, run.start);
    for (std::uint32_t n = 0; n < run.length; ++n) {
      const float extinction = voxels[n].extinction_per_mm;
      if (extinction <= 0) continue;
      const std::uint32_t at = run.start + n;
      while (at >= spans[s].start + spans[s].length) ++s;
      const std::size_t offset = spans[s].offset + (at - spans[s].start);
      const std::array<float, 3> rgb = look.emission(voxels[n]);
      out.plane(Plane::kExtinction)[offset] = extinction;
      out.plane(Plane::kRed)[offset] = rgb[0];
      out.plane(Plane::kGreen)[offset] = rgb[1];
      out.plane(Plane::kBlue)[offset] = rgb[2];
      if (shaded)
        out.shaded.push_back({offset, context.cache.normals()[first_voxel + n * context.scan_stride], rgb});
    }
    voxels += run.length;
  }
}

SliceSpans build_slice(const BuildContext& context, std::int64_t slice) {
  const SelectedRuns& selected = context.selected;
  SliceSpans out;
  const auto first_scanline = static_cast<std::size_t>((slice - selected.slice_first) * selected.rows);
  if (selected.first_run[first_scanline] ==
      selected.first_run[first_scanline + static_cast<std::size_t>(selected.rows)]) {
    return out;
  }

  std::vector<VoxelLook> voxels;
  for (std::int64_t row = selected.row_first; row < selected.row_first + selected.rows; ++row) {
    for (const SelectedRun& run : selected.scanline(slice, row)) {
      voxels.resize(voxels.size() + run.length);
      context.looks[run.draw].look_up(context.cache.values(), context.voxel(slice, row, run.start),
                                      context.scan_stride, run.length,
                                      voxels.data() + voxels.size() - run.length);
    }
  }

  // Zeros before the first span, too.
  out.plane_floats = kSpanPadding;
  out.first_span.reserve(static_cast<std::size_t>(selected.rows) + 1);
  const VoxelLook* next = voxels.data();
  for (std::int64_t row = selected.row_first; row < selected.row_first + selected.rows; ++row) {
    out.first_span.push_back(static_cast<std::uint32_t>(out.spans.size()));
    const auto runs = selected.scanline(slice, row);
    cut_spans(runs, next, out);
    for (const SelectedRun& run : runs) next += run.length;
  }
  out.first_span.push_back(static_cast<std::uint32_t>(out.spans.size()));
  if (out.spans.empty()) return out;

  out.planes = std::make_unique<float[]>(kPlanes * out.plane_floats);
  next = voxels.data();
  for (std::int64_t row = selected.row_first; row < selected.row_first + selected.rows; ++row) {
    const auto n = static_cast<std::size_t>(row - selected.row_first);
    const auto runs = selected.scanline(slice, row);
    pack_spans(context, slice, row, runs, next,
               std::span(out.spans).subspan(out.first_span[n], out.first_span[n + 1] - out.first_span[n]),
               out);
    for (const SelectedRun& run : runs) next += run.length;
  }
  return out;
}

}  // namespace

std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // As if every voxel were shaded, and every run a span with a gap before it. Runs that grey values cut
  // further lose at least kMaxSpanGap + 1 voxels at each cut, which is worth more than the padding of another
  // span.
  constexpr std::uint64_t kLight = kPlanes * sizeof(float);
  return voxels * (kLight + sizeof(ShadedVoxel)) +
         runs * ((kSpanPadding + kMaxSpanGap) * kLight + sizeof(Span));
}

SpanModel build_spans(const SelectedRuns& selected, const DrawPlan& plan, std::span<const VolumeLook> looks,
                      const Grid& grid, const ClassCache& cache, bool shade, ThreadPool& pool) {
  const ScanOrder scan = ScanOrder::of(selected.axis);
  const std::array<std::size_t, 3> step{1, static_cast<std::size_t>(grid.size[0]),
                                        static_cast<std::size_t>(grid.size[0] * grid.size[1])};
  const BuildContext context{
      selected, plan, looks, cache, shade, step[scan.slice_axis], step[scan.row_axis], step[scan.scan_axis]};
  SpanModel model;
  model.axis = selected.axis;
  model.slice_first = selected.slice_first;
  model.row_first = selected.row_first;
  model.rows = selected.rows;
  model.scan_first = selected.scan_first;
  model.scan_voxels = selected.scan_voxels;
  model.slices.resize(static_cast<std::size_t>(selected.slices));
  pool.for_each(model.slices.size(), [&](std::size_t n) {
    model.slices[n] = build_slice(context, selected.slice_first + static_cast<std::int64_t>(n));
  });
  for (const SliceSpans& slice : model.slices) {
    model.voxels += slice.voxels;
    model.shaded_voxels += slice.shaded.size();
  }
  return model;
}

void shade_spans(SpanModel& model, std::span<const float> light, ThreadPool& pool) {
  pool.for_each(model.slices.size(), [&](std::size_t n) {
    SliceSpans& slice = model.slices[n];
    for (const ShadedVoxel& voxel : slice.shaded) {
      const float factor = light[voxel.normal];
      slice.plane(Plane::kRed)[voxel.offset] = voxel.emission[0] * factor;
      slice.plane(Plane::kGreen)[voxel.offset] = voxel.emission[1] * factor;
      slice.plane(Plane::kBlue)[voxel.offset] = voxel.emission[2] * factor;
    }
  });
}

}  // namespace splatlas
