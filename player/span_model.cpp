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
  int emissions;
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

void set_emission(SliceSpans& slice, std::size_t place, const std::array<float, 3>& emission, float factor) {
  for (std::size_t c = 0; c < static_cast<std::size_t>(slice.emissions); ++c)
    slice.light[place + (c + 1) * kBlock] = emission[c] * factor;
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
      if (voxels[n].extinction_per_mm <= 0) continue;
      const std::uint32_t at = run.start + n;
      while (at >> kBlockBits >= spans[s].first_block + spans[s].blocks) ++s;
      ShadedVoxel voxel = out.set_light(spans[s], at, look, voxels[n]);
      if (!shaded) continue;
      voxel.normal = context.cache.normals()[first_voxel + n * context.scan_stride];
      out.shaded.push_back(voxel);
    }
    voxels += run.length;
  }
}

SliceSpans build_slice(const BuildContext& context, std::int64_t slice) {
  const SelectedRuns& selected = context.selected;
  SliceSpans out;
  out.emissions = context.emissions;
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

void SliceSpans::find_rows() {
  const auto rows = static_cast<std::int64_t>(first_span.size()) - 1;
  first_row = 0;
  last_row = std::max<std::int64_t>(rows, 0);
  while (first_row < last_row && row(first_row).empty()) ++first_row;
  while (first_row < last_row && row(last_row - 1).empty()) --last_row;
}

void SliceSpans::allocate_light() {
  std::uint32_t blocks = 0;
  for (Span& span : spans) {
    span.offset = blocks;
    blocks += span.blocks;
  }
  light.reset(new (kLightAlignment) float[light_floats()]());
  find_rows();
}

ShadedVoxel SliceSpans::set_light(const Span& span, std::uint32_t voxel, const VolumeLook& look,
                                  const VoxelLook& seen) {
  ShadedVoxel written{place(span, voxel), 0, look.emission(seen)};
  if (emissions == 1) written.emission[0] = seen.extinction_per_mm * seen.shade;
  light[written.place] = seen.extinction_per_mm;
  set_emission(*this, written.place, written.emission, 1);
  return written;
}

std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // As if every voxel were shaded, and every run a span of its own with blocks that it hardly fills. Voxels
  // that grey values leave out make runs into several spans only where whole blocks are left out.
  constexpr std::uint64_t kLight = 4 * sizeof(float);
  return voxels * (kLight + sizeof(ShadedVoxel)) + runs * (2 * kBlock * kLight + sizeof(Span));
}

SpanModel build_spans(const SelectedRuns& selected, const DrawPlan& plan, std::span<const VolumeLook> looks,
                      const Grid& grid, const ClassCache& cache, bool shade, ThreadPool& pool) {
  const ScanOrder scan = ScanOrder::of(selected.axis);
  const std::array<std::size_t, 3> step{1, static_cast<std::size_t>(grid.size[0]),
                                        static_cast<std::size_t>(grid.size[0] * grid.size[1])};
  const std::optional<std::array<float, 3>> color = common_color(plan, looks);
  const BuildContext context{selected,
                             plan,
                             looks,
                             cache,
                             shade,
                             color ? 1 : 3,
                             step[scan.slice_axis],
                             step[scan.row_axis],
                             step[scan.scan_axis]};
  SpanModel model;
  model.axis = selected.axis;
  model.slice_first = selected.slice_first;
  model.row_first = selected.row_first;
  model.rows = selected.rows;
  model.scan_first = selected.scan_first;
  model.scan_voxels = selected.scan_voxels;
  model.emissions = context.emissions;
  model.color = color.value_or(model.color);
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
    for (const ShadedVoxel& voxel : slice.shaded)
      set_emission(slice, voxel.place, voxel.emission, light[voxel.normal]);
  });
}

}  // namespace splatlas
