#include "player/render/sheets/spans/build_spans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

/// Prefetches grey values of a following row, whose runs are usually similar; rows may be far apart in
/// memory.
void prefetch(std::size_t voxel, std::size_t voxels, const ClassCache& cache) {
  constexpr std::size_t kLine = 64;
  const std::size_t last = std::min((voxel + voxels) * cache.value_bytes(), cache.bytes_of_values());
  for (std::size_t at = voxel * cache.value_bytes(); at < last; at += kLine)
    hwy::Prefetch(cache.values() + at);
}

}  // namespace

std::pair<std::int64_t, std::int64_t> SheetStrip::rows_of(std::int64_t slice) const {
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

/// Flags of the model's slices.
std::vector<bool> SpanBuilder::changed_slices(const SpanRequest& request, const SpanModel& before,
                                              const ClassAppearances& appearances_before) const {
  const bool other_kind = before.emissions != model_.emissions || appearances_before.of_class.empty() ||
                          appearances_before.generation != appearances_.generation ||
                          appearances_before.shade != appearances_.shade;
  std::vector<bool> changed(model_.slices.size(), other_kind);
  if (other_kind) return changed;
  const std::uint8_t slice_axis = ScanOrder::of(model_.axis).slice_axis;
  const std::int64_t beside = request.shade && request.cache.values() != nullptr ? 1 : 0;
  const auto in_model = [&](std::int64_t slice) {
    return changed.begin() + static_cast<std::ptrdiff_t>(model_.place_of(slice));
  };
  for (ClassId c = 0; c < appearances_.of_class.size(); ++c) {
    if (!appearances_.differ(appearances_before, c)) continue;
    const IndexBox& box = request.classes.box(c);
    // Gradients of grey values reach into the slices beside
    std::fill(in_model(box.first[slice_axis] - beside), in_model(box.last[slice_axis] + 1 + beside), true);
  }
  return changed;
}

/// Moves unchanged slices from `before`. Slices without a predecessor become changed; changed slices free
/// their memory.
void SpanBuilder::take_over(SpanModel& before, std::vector<bool>& changed) {
  std::vector<bool> taken(model_.slices.size(), false);
  for (SliceSpans& slice : before.slices) {
    const std::size_t place = model_.place_of(slice.number);
    if (place == model_.slices.size() || model_.slices[place].number != slice.number) continue;
    taken[place] = true;
    model_.slices[place] = std::move(slice);
  }
  before.slices.clear();
  std::uint64_t kept = 0;
  for (std::size_t n = 0; n < model_.slices.size(); ++n) {
    if (!taken[n]) changed[n] = true;
    if (changed[n]) model_.slices[n].optics = {};
    kept += model_.slices[n].optics.size() * sizeof(float);
  }
  // Rebuild everything if the remaining slices leave the arena fragmented.
  if (arena_.bytes_in_use() <= 2 * kept + kMaxUnusedBytes) return;
  changed.assign(changed.size(), true);
  for (SliceSpans& slice : model_.slices) slice.optics = {};
}

/// All blocks of the runs, and an empty block behind each of them.
std::size_t SpanBuilder::max_floats(const SpanRequest& request, std::int64_t slice) const {
  std::int64_t blocks = 0;
  request.for_each_run(slice, [&](const ClassRun& run, std::uint32_t) { blocks += run.length / kBlock + 3; });
  return static_cast<std::size_t>(blocks * kBlock * (1 + model_.emissions));
}

void SpanBuilder::write_slice(const SpanRequest& request, std::int64_t slice, VoxelLighter& lighter,
                              SliceSpans& out) const {
  const ScanOrder scan = ScanOrder::of(model_.axis);
  const std::array<std::size_t, 3> step{
      1, static_cast<std::size_t>(request.grid.size[0]),
      static_cast<std::size_t>(request.grid.size[0] * request.grid.size[1])};
  const std::size_t row_step = step[scan.row_axis], scan_step = step[scan.scan_axis];
  const std::size_t first_voxel = static_cast<std::size_t>(slice) * step[scan.slice_axis];
  constexpr std::size_t kRowsAhead = 2;
  SpanWriter writer(model_.emissions, out);

  // Classify the grey values of a piece
  const auto write = [&](const Piece& piece) {
    const SpanAppearance& appearance = appearances_.appearances[piece.appearance];
    const std::size_t voxel =
        first_voxel + static_cast<std::size_t>(piece.row) * row_step + piece.start * scan_step;
    if (model_.axis == Axis::kY) prefetch(voxel + kRowsAhead * row_step, piece.length, request.cache);
    writer.add(piece.start, piece.length);
    appearance.volume.look_up(request.cache.values(), voxel, scan_step, piece.length,
                              writer.extinctions(piece.start), writer.whites(piece.start));
    writer.color(
        piece.start, piece.length, appearance.volume.color,
        lighter.light(appearance.volume, appearance.boundary, slice, piece.row, piece.start, piece.length));
  };

  // Merge adjacent runs into pieces
  Piece piece;
  request.for_each_run(slice, [&](const ClassRun& run, std::uint32_t) {
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
  writer.finish();
}

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

void set_box(const SelectedRuns& runs, SpanModel& model) {
  model.axis = runs.axis();
  model.scan_first = runs.box().first[0];
  model.scan_voxels = runs.scan_voxels();
  model.row_first = runs.box().first[1];
  model.rows = runs.rows();
  model.slice_first = runs.box().first[2];
  model.slice_count = runs.slices();
}

SpanModel empty_model(const SpanRequest& request) {
  SpanModel model;
  set_box(request.runs, model);
  set_appearances(request.plan, request.appearances.appearances(), request.classes, model);
  return model;
}

void SpanBuilder::build(const SpanRequest& request, ThreadPool& pool) {
  const SelectedRuns& runs = request.runs;
  SpanModel before = std::exchange(model_, empty_model(request));
  for (const std::int64_t slice : runs.occupied()) model_.slices.emplace_back().number = slice;
  const ClassAppearances appearances_before =
      std::exchange(appearances_, class_appearances(request, model_.emissions > 1));

  // Find the slices to rebuild
  std::vector<bool> changed = changed_slices(request, before, appearances_before);
  take_over(before, changed);
  std::vector<std::size_t> to_build;
  for (std::size_t n = 0; n < changed.size(); ++n) {
    if (changed[n]) to_build.push_back(n);
  }

  // Build slices in parallel
  const std::uint64_t voxels = request.plan.volume_voxels + request.plan.hybrid_voxels;
  arena_.expect(voxels * (1 + static_cast<std::uint64_t>(model_.emissions)) * sizeof(float));
  VoxelLighters lighters(runs, request.cache, request.grid, request.shade);
  pool.for_each((to_build.size() + kSlicesAtOnce - 1) / kSlicesAtOnce, [&](std::size_t part) {
    const std::size_t first = part * kSlicesAtOnce;
    lighters.with([&](VoxelLighter& lighter) {
      std::size_t lit = 0, lit_runs = 0;  // of the slice before, which is usually similar
      for (std::size_t n = first; n < std::min(first + kSlicesAtOnce, to_build.size()); ++n) {
        SliceSpans& slice = model_.slices[to_build[n]];
        slice.is_lit = false;
        slice.optics = arena_.lend(max_floats(request, slice.number));
        slice.lit.voxels.reserve(lit + lit / 8);
        slice.lit.runs.reserve(lit_runs + lit_runs / 8);
        write_slice(request, slice.number, lighter, slice);
        lit = slice.lit.voxels.size();
        lit_runs = slice.lit.runs.size();
        arena_.settle(slice.optics);
      }
    });
  });

  // Update counters and free unused memory
  slices_built_ = to_build.size();
  for (const SliceSpans& slice : model_.slices) {
    model_.voxels += slice.voxels;
    model_.lit_voxels += slice.lit.voxels.size();
  }
  arena_.trim(std::max(arena_.bytes_in_use(), kMaxUnusedBytes));
}

}  // namespace splatlas
