#include "player/span_model.h"

#include <algorithm>
#include <new>

namespace splatlas {
namespace {

constexpr std::align_val_t kLightAlignment{64};

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

/// Appends the spans of one scanline. `voxels` holds the looks of its runs, run after run.
void cut_spans(std::span<const SelectedRun> runs, const VoxelLook* voxels, SliceSpans& out) {
  const std::size_t first_of_row = out.spans.size();
  for (const SelectedRun& run : runs) {
    for (std::uint32_t n = 0; n < run.length; ++n) {
      if (voxels[n].extinction_per_mm > 0) out.add_voxel(first_of_row, run.start + n);
    }
    voxels += run.length;
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
      while (at >> kBlockBits >= spans[s].first_block + spans[s].blocks) ++s;
      const std::size_t place = spans[s].place(at);
      const std::array<float, 3> rgb = look.emission(voxels[n]);
      float* light = &out.light[place];
      light[0] = extinction;
      for (std::size_t c = 0; c < 3; ++c) light[(c + 1) * kBlock] = rgb[c];
      if (shaded)
        out.shaded.push_back({place, context.cache.normals()[first_voxel + n * context.scan_stride], rgb});
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

  out.allocate_light();
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

void FreeLight::operator()(float* light) const {
  ::operator delete[](light, kLightAlignment);
}

void SliceSpans::add_voxel(std::size_t first_of_row, std::uint32_t voxel) {
  const std::uint32_t block = voxel >> kBlockBits;
  const std::uint32_t end = ((voxel + 1) >> kBlockBits) + 1;  // the footprint reaches the next voxel
  if (spans.size() == first_of_row || block > spans.back().first_block + spans.back().blocks) {
    spans.push_back({block, end - block, 1, 0});
  } else {
    spans.back().blocks = std::max(spans.back().blocks, end - spans.back().first_block);
    ++spans.back().voxels;
  }
  ++voxels;
}

void SliceSpans::allocate_light() {
  std::size_t floats = 0;
  for (Span& span : spans) {
    span.offset = floats;
    floats += std::size_t{span.blocks} * static_cast<std::size_t>(kBlockFloats);
  }
  light.reset(new (kLightAlignment) float[floats]());
}

std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // As if every voxel were shaded, and every run a span of its own with blocks that it hardly fills. Voxels
  // that grey values leave out make runs into several spans only where whole blocks are left out.
  constexpr std::uint64_t kLight = kPlanes * sizeof(float);
  return voxels * (kLight + sizeof(ShadedVoxel)) + runs * (2 * kBlock * kLight + sizeof(Span));
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
      float* light_of_voxel = &slice.light[voxel.place];
      for (std::size_t c = 0; c < 3; ++c) light_of_voxel[(c + 1) * kBlock] = voxel.emission[c] * factor;
    }
  });
}

}  // namespace splatlas
