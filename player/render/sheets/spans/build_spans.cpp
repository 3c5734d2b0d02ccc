#include "player/render/sheets/spans/build_spans.h"

#include <array>
#include <cmath>

#include <hwy/cache_control.h>

#include "player/render/sheets/spans/span_writer.h"

namespace splatlas {
namespace {

/// Adjacent runs of one scanline with the same appearance.
struct Piece {
  std::int64_t row = 0;
  std::uint32_t start = 0, length = 0;
  std::uint32_t appearance = SelectedRuns::kNotDrawn;

  [[nodiscard]] bool goes_on(const ClassRun& run, std::uint32_t appearance_of_run) const {
    return run.row == row && run.start == start + length && appearance_of_run == appearance;
  }
};

/// Slices per parallel task.
constexpr std::size_t kSlicesAtOnce = 8;

/// Limit for idle and fragmented arena memory, unless the model itself uses more.
constexpr std::uint64_t kMaxUnusedBytes = std::uint64_t{64} << 20;

/// Prefetches the grey values of a following row, usually with similar runs, and its light if it is shaded.
/// Rows may be far apart in memory.
void prefetch(std::size_t voxel, std::size_t voxels, const ClassCache& cache, bool shade) {
  constexpr std::size_t kLine = 64;
  const auto lines = [&](const std::byte* grid, std::size_t voxel_bytes, std::size_t bytes) {
    const std::size_t last = std::min((voxel + voxels) * voxel_bytes, bytes);
    for (std::size_t at = voxel * voxel_bytes; at < last; at += kLine) hwy::Prefetch(grid + at);
  };
  lines(cache.values(), cache.value_bytes(), cache.bytes_of_values());
  if (shade)
    lines(reinterpret_cast<const std::byte*>(cache.lights()), sizeof(VoxelLight), cache.bytes_of_lights());
}

}  // namespace

void set_appearances(const DrawPlan& plan, std::span<const VolumeAppearance> appearances,
                     const ClassTable& classes, SpanModel& model) {
  std::optional<std::array<float, 3>> color;
  bool differ = false;
  double voxels = 0, extinctions = 0;
  for (std::size_t n = 0; n < appearances.size(); ++n) {
    if (!draws_volume(plan.classes[n].role)) continue;
    differ |= color && *color != appearances[n].color;
    color = appearances[n].color;
    const auto of_class = static_cast<double>(classes.voxels(plan.classes[n].id));
    voxels += of_class;
    extinctions += of_class * static_cast<double>(appearances[n].extinction_per_mm);
  }
  const bool one_color = color && !differ;
  model.emissions = one_color ? 1 : 3;
  model.color = one_color ? *color : std::array<float, 3>{1, 1, 1};
  model.mean_densest_per_mm = voxels > 0 ? extinctions / voxels : 0;
}

RowRange SheetStrip::rows_of(std::int64_t slice) const {
  const double before = shear.v_shift(static_cast<double>(slice) - 1);
  const double behind = shear.v_shift(static_cast<double>(slice) + 1);
  const auto [least, most] = std::minmax(before, behind);
  return {static_cast<std::int64_t>(std::floor(static_cast<double>(first) - most)) - 1,
          static_cast<std::int64_t>(std::ceil(static_cast<double>(last) - least)) + 2};
}

bool SpanBuilder::ClassAppearances::differ(const ClassAppearances& other, ClassId c) const {
  const std::uint32_t mine = of_class[c], theirs = other.of_class[c];
  if (mine == kNotDrawn || theirs == kNotDrawn) return mine != theirs;
  return appearances[mine] != other.appearances[theirs];
}

/// Classes of one structure are usually adjacent, and so are equal appearances.
SpanBuilder::ClassAppearances SpanBuilder::class_appearances(const SpanRequest& request, bool colored) {
  ClassAppearances found{{},
                         std::vector<std::uint32_t>(request.classes.size(), kNotDrawn),
                         request.appearances.generation(),
                         request.shade};
  for (std::size_t n = 0; n < request.plan.classes.size(); ++n) {
    const ClassDraw& draw = request.plan.classes[n];
    if (!draws_volume(draw.role)) continue;
    SpanAppearance appearance{request.appearances.appearances()[n], draw.boundary};
    if (!colored) appearance.volume.color = {1, 1, 1};
    // Search only the latest two, usually interior and boundary. Earlier duplicates are harmless.
    auto known =
        std::find(found.appearances.end() - std::min<std::ptrdiff_t>(2, std::ssize(found.appearances)),
                  found.appearances.end(), appearance);
    if (known == found.appearances.end()) known = found.appearances.insert(known, appearance);
    found.of_class[draw.id] = static_cast<std::uint32_t>(known - found.appearances.begin());
  }
  return found;
}

/// Of each of the model's slices.
std::vector<RowRange> SpanBuilder::changed_rows(const SpanRequest& request, const SpanModel& before,
                                                const ClassAppearances& appearances_before) const {
  const ScanOrder scan = ScanOrder::of(model_.axis);
  std::vector<RowRange> changed(model_.slices.size(), {0, request.grid.size[scan.row_axis]});
  if (before.emissions != model_.emissions || appearances_before.of_class.empty() ||
      appearances_before.generation != appearances_.generation ||
      appearances_before.shade != appearances_.shade) {
    for (std::size_t n = 0; request.strip && n < changed.size(); ++n)
      changed[n] = request.strip->rows_of(model_.slices[n].number);
    return changed;
  }
  std::vector<bool> differ(appearances_.of_class.size());
  IndexBox box;
  for (ClassId c = 0; c < differ.size(); ++c) {
    differ[c] = appearances_.differ(appearances_before, c);
    if (differ[c]) box.include(request.classes.box(c));
  }
  const auto differs = [&](const ClassRun& run) { return differ[run.id]; };
  changed.assign(changed.size(), {});
  for (std::size_t n = 0; n < changed.size(); ++n) {
    const std::int64_t slice = model_.slices[n].number;
    if (slice < box.first[scan.slice_axis] || slice > box.last[scan.slice_axis]) continue;
    const auto runs = request.cache.runs(model_.axis).slice(slice);  // by row
    const auto begin = std::ranges::lower_bound(runs, box.first[scan.row_axis], {}, &ClassRun::row);
    const auto end = std::ranges::upper_bound(runs, box.last[scan.row_axis], {}, &ClassRun::row);
    const auto first = std::find_if(begin, end, differs);
    if (first == end) continue;
    const auto last = std::find_if(std::reverse_iterator(end), std::reverse_iterator(first), differs);
    changed[n] = {first->row, last->row + 1};
  }
  return changed;
}

/// Moves slices from `before`. False if they leave the arena fragmented.
bool SpanBuilder::take_over(SpanModel& before) {
  std::uint64_t kept = 0;
  for (SliceSpans& slice : before.slices) {
    const std::size_t place = model_.place_of(slice.number);
    if (place == model_.slices.size() || model_.slices[place].number != slice.number) continue;
    kept += slice.optics.size() * sizeof(float);
    model_.slices[place] = std::move(slice);
  }
  before.slices.clear();
  return arena_.bytes_in_use() <= 2 * kept + kMaxUnusedBytes;
}

/// All blocks of the runs, and an empty block behind each of them.
std::size_t SpanBuilder::max_floats(const SpanRequest& request, std::int64_t slice,
                                    const RowRange& rows) const {
  std::int64_t blocks = 0;
  request.runs.for_each(slice, rows.first, rows.last,
                        [&](const ClassRun& run, std::uint32_t) { blocks += run.length / kBlock + 3; });
  return static_cast<std::size_t>(blocks * kBlock * (1 + model_.emissions));
}

/// `before`: the same slice, with rows to keep.
void SpanBuilder::write_slice(const SpanRequest& request, const RowRange& rows, const SliceSpans& before,
                              SliceSpans& out) const {
  const std::int64_t slice = out.number;
  const ScanOrder scan = ScanOrder::of(model_.axis);
  const std::array<std::size_t, 3> step{
      1, static_cast<std::size_t>(request.grid.size[0]),
      static_cast<std::size_t>(request.grid.size[0] * request.grid.size[1])};
  const std::size_t row_step = step[scan.row_axis], scan_step = step[scan.scan_axis];
  const std::size_t first_voxel = static_cast<std::size_t>(slice) * step[scan.slice_axis];
  constexpr std::size_t kRowsAhead = 2;
  SpanWriter writer(model_.emissions, out);
  writer.copy(before, before.first_row, rows.first);

  // Classify the grey values of a piece
  const auto write = [&](const Piece& piece) {
    const SpanAppearance& appearance = appearances_.appearances[piece.appearance];
    const std::size_t voxel =
        first_voxel + static_cast<std::size_t>(piece.row) * row_step + piece.start * scan_step;
    if (model_.axis == Axis::kY)
      prefetch(voxel + kRowsAhead * row_step, piece.length, request.cache, request.shade);
    writer.add(piece.start, piece.length);
    appearance.volume.look_up(request.cache.values(), voxel, scan_step, piece.length,
                              writer.extinctions(piece.start), writer.whites(piece.start));
    writer.color(piece.start, piece.length, appearance.volume.color,
                 request.shade ? request.cache.light(voxel, appearance.boundary) : nullptr, scan_step);
  };

  // Merge adjacent runs into pieces
  Piece piece;
  request.runs.for_each(slice, rows.first, rows.last, [&](const ClassRun& run, std::uint32_t) {
    const std::uint32_t appearance = appearances_.of_class[run.id];
    if (piece.goes_on(run, appearance)) {
      piece.length += run.length;
      return;
    }
    if (piece.length > 0) write(piece);
    if (run.row != piece.row) writer.end_row(piece.row);
    piece = {run.row, run.start, run.length, appearance};
  });
  if (piece.length > 0) write(piece);
  writer.end_row(piece.row);
  writer.copy(before, rows.last, before.last_row);
  writer.finish();
}

SpanModel empty_model(const SpanRequest& request) {
  const SelectedRuns& runs = request.runs;
  SpanModel model;
  model.axis = runs.axis();
  model.scan_first = runs.box().first[0];
  model.scan_voxels = runs.scan_voxels();
  model.row_first = runs.box().first[1];
  model.rows = runs.rows();
  model.slice_first = runs.box().first[2];
  model.slice_count = runs.slices();
  set_appearances(request.plan, request.appearances.appearances(), request.classes, model);
  return model;
}

void SpanBuilder::build(const SpanRequest& request, ThreadPool& pool) {
  const SelectedRuns& runs = request.runs;
  SpanModel before = std::exchange(model_, empty_model(request));
  for (const std::int64_t slice : runs.occupied()) model_.slices.emplace_back().number = slice;
  ClassAppearances appearances_before =
      std::exchange(appearances_, class_appearances(request, model_.emissions > 1));
  if (!take_over(before)) appearances_before = {};  // rebuild everything

  // Find the slices to rebuild
  std::vector<RowRange> changed = changed_rows(request, before, appearances_before);
  std::vector<std::size_t> to_build;
  rows_built_ = 0;
  for (std::size_t n = 0; n < changed.size(); ++n) {
    RowRange& rows = changed[n];
    SliceSpans& slice = model_.slices[n];
    if (rows.empty()) continue;
    // Copies of few rows are not worth their memory
    if (slice.optics.size() > 0 && 2 * (rows.last - rows.first) > slice.last_row - slice.first_row) {
      rows.include({slice.first_row, slice.last_row});
      slice.optics = {};
    }
    to_build.push_back(n);
    rows_built_ += rows.last - rows.first;
  }

  // Build slices in parallel
  const std::uint64_t voxels = request.plan.volume_voxels + request.plan.hybrid_voxels;
  arena_.expect(voxels * (1 + static_cast<std::uint64_t>(model_.emissions)) * sizeof(float));
  pool.for_each((to_build.size() + kSlicesAtOnce - 1) / kSlicesAtOnce, [&](std::size_t part) {
    const std::size_t first = part * kSlicesAtOnce;
    SliceSpans before;  // passes its memory on to the next slice
    for (std::size_t n = first; n < std::min(first + kSlicesAtOnce, to_build.size()); ++n) {
      SliceSpans& slice = model_.slices[to_build[n]];
      const RowRange& rows = changed[to_build[n]];
      std::swap(slice, before);
      const auto& similar = n == first ? before.lights : model_.slices[to_build[n - 1]].lights;
      slice.number = before.number;
      slice.optics = arena_.lend(before.optics.size() + max_floats(request, slice.number, rows));
      slice.lights.reserve(similar.size() * 9 / 8);
      write_slice(request, rows, before, slice);
      before.optics = {};
      arena_.settle(slice.optics);
    }
  });

  // Update counters and free unused memory
  for (const SliceSpans& slice : model_.slices) model_.voxels += slice.voxels;
  arena_.trim(std::max(arena_.bytes_in_use(), kMaxUnusedBytes));
}

}  // namespace splatlas
