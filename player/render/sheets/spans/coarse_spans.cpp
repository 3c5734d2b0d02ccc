#include "player/render/sheets/spans/coarse_spans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/sheets/spans/span_writer.h"

namespace splatlas {
namespace {

/// Blocks [first, first + count) of the grid that cover voxels `from` to `to`.
struct BlockRange {
  std::int64_t first = 0, count = 0;

  BlockRange(std::int64_t from, std::int64_t to, int level)
      : first(from >> level), count((to >> level) - first + 1) {}
};

/// Sums over the voxels of a block.
struct Sums {
  float extinction = 0;
  std::array<float, 3> emission{};
  float lit = 0, white = 0;  ///< emission of white: of boundary voxels, and of all
  std::array<float, 3> normal{};
};

/// Builds the slices of blocks, one at a time.
class SliceAverager {
 public:
  SliceAverager(const SpanRequest& request, int level, const SpanModel& model)
      : request_(request),
        level_(level),
        model_(model),
        scan_(ScanOrder::of(model.axis)),
        row_(static_cast<std::size_t>(model.scan_voxels)),
        normals_(row_.size()),
        lit_(row_.size()) {}

  /// Gathers the runs of a slice of blocks, row by row. Returns an upper bound of its floats.
  std::size_t gather(std::int64_t slice) {
    runs_.clear();
    std::size_t blocks = 0;
    for (std::int64_t of = slice << level_; of < (slice + 1) << level_; ++of) {
      request_.runs.for_each(of, [&](const ClassRun& run, std::uint32_t draw) {
        runs_.push_back({run.row >> level_, of, run, draw});
        blocks += (run.length >> level_) / kBlock + 3;
      });
    }
    std::ranges::stable_sort(runs_, {}, &PlacedRun::row);
    return blocks * kBlock * static_cast<std::size_t>(1 + model_.emissions);
  }
  /// Writes the slice of the gathered runs.
  void write(SliceSpans& out) {
    SpanWriter writer(model_.emissions, out);
    for (auto run = runs_.begin(); run != runs_.end();) {
      const std::uint32_t row = run->row;
      first_ = row_.size();
      last_ = 0;
      for (; run != runs_.end() && run->row == row; ++run) add(run->slice, run->run, run->draw);
      write_row(row, writer);
    }
    writer.finish();
  }

 private:
  struct PlacedRun {
    std::uint32_t row = 0;  // of blocks
    std::int64_t slice = 0;
    ClassRun run;
    std::uint32_t draw = 0;
  };

  /// Adds the voxels of a run to the sums of their blocks.
  void add(std::int64_t slice, const ClassRun& run, std::uint32_t draw) {
    constexpr std::uint32_t kAtOnce = 256;
    const VolumeAppearance& look = request_.appearances.appearances()[draw];
    const bool shaded = request_.shade && request_.plan.classes[draw].boundary;
    const Index3& size = request_.grid.size;
    const std::array<std::int64_t, 3> steps{1, size[0], size[0] * size[1]};
    const auto step = static_cast<std::size_t>(steps[scan_.scan_axis]);
    auto voxel = static_cast<std::size_t>(slice * steps[scan_.slice_axis] + run.row * steps[scan_.row_axis] +
                                          run.start * steps[scan_.scan_axis]);
    std::array<float, kAtOnce> extinctions, whites;
    for (std::uint32_t done = 0; done < run.length; done += kAtOnce) {
      const std::uint32_t count = std::min(kAtOnce, run.length - done);
      look.look_up(request_.cache.values(), voxel, step, count, extinctions.data(), whites.data());
      for (std::uint32_t n = 0; n < count; ++n) {
        Sums& sums = at(run.start + done + n);
        sums.extinction += extinctions[n];
        sums.white += whites[n];
        for (std::size_t c = 0; c < 3; ++c) sums.emission[c] += whites[n] * look.color[c];
        if (!shaded) continue;
        sums.lit += whites[n];
        const PackedNormal normal = request_.cache.normals()[voxel + n * step];
        sums.normal[0] += whites[n] * unpacked_.x[normal];
        sums.normal[1] += whites[n] * unpacked_.y[normal];
        sums.normal[2] += whites[n] * unpacked_.z[normal];
      }
      voxel += count * step;
    }
    first_ = std::min(first_, index(run.start));
    last_ = std::max(last_, index(run.start + run.length - 1) + 1);
  }

  [[nodiscard]] std::size_t index(std::uint32_t voxel) const {
    return static_cast<std::size_t>((std::int64_t{voxel} >> level_) - model_.scan_first);
  }
  [[nodiscard]] Sums& at(std::uint32_t voxel) { return row_[index(voxel)]; }

  /// Writes the means of a row, run by run, and clears its sums.
  void write_row(std::int64_t row, SpanWriter& writer) {
    const float per_voxel = std::ldexp(1.0f, -3 * level_);
    for (std::size_t begin = first_; begin < last_;) {
      if (row_[begin].extinction <= 0) {
        ++begin;
        continue;
      }
      std::size_t end = begin;
      while (end < last_ && row_[end].extinction > 0) ++end;
      const auto first = static_cast<std::uint32_t>(model_.scan_first + static_cast<std::int64_t>(begin));
      const auto count = static_cast<std::uint32_t>(end - begin);
      writer.add(first, count);
      for (std::size_t n = begin; n < end; ++n) {
        const Sums& sums = row_[n];
        writer.extinctions(first)[n - begin] = sums.extinction * per_voxel;
        for (int c = 0; c < model_.emissions; ++c) {
          const float sum = model_.emissions == 1 ? sums.white : sums.emission[static_cast<std::size_t>(c)];
          writer.emissions(first, c)[n - begin] = sum * per_voxel;
        }
        if (sums.lit > 0) normals_[n] = pack_normal(sums.normal);
        const float share = sums.white > 0 ? sums.lit / sums.white : 0;
        lit_[n] = static_cast<std::uint16_t>(std::lround(std::min(share, 1.0f) * ShadedVoxel::kAllLit));
      }
      writer.shade(first, count, &normals_[begin], 1, &lit_[begin]);
      begin = end;
    }
    writer.end_row(row);
    std::fill(row_.begin() + static_cast<std::ptrdiff_t>(first_),
              row_.begin() + static_cast<std::ptrdiff_t>(last_), Sums{});
  }

  const SpanRequest& request_;
  const int level_;
  const SpanModel& model_;
  const ScanOrder scan_;
  const UnpackedNormals& unpacked_ = unpacked_normals();
  std::vector<PlacedRun> runs_;
  // Of the current row, from block scan_first on; sums are zero outside [first_, last_).
  std::vector<Sums> row_;
  std::vector<PackedNormal> normals_;
  std::vector<std::uint16_t> lit_;
  std::size_t first_ = 0, last_ = 0;
};

}  // namespace

Grid coarse_grid(const Grid& grid, int level) {
  Grid coarse = grid;
  const double middle = (std::ldexp(1.0, level) - 1) / 2;  // of the first block, in voxels
  coarse.origin_lps_mm = index_to_lps_mm(grid).apply({middle, middle, middle});
  for (std::size_t a = 0; a < 3; ++a) {
    coarse.size[a] = ((grid.size[a] - 1) >> level) + 1;
    coarse.spacing_mm[a] = std::ldexp(grid.spacing_mm[a], level);
  }
  return coarse;
}

CoarseSpans::CoarseSpans(const SpanRequest& request, int level, ThreadPool& pool)
    : level_(level), shaded_(request.shade), runs_(request.runs.count()) {
  // Set the model's frame and appearances
  const SelectedRuns& runs = request.runs;
  model_.axis = runs.axis();
  set_appearances(request.plan, request.appearances.appearances(), request.classes, model_);
  const IndexBox& box = runs.box();
  if (runs.count() == 0) return;
  const BlockRange scan(box.first[0], box.last[0], level), rows(box.first[1], box.last[1], level),
      slices(box.first[2], box.last[2], level);
  model_.scan_first = scan.first;
  model_.scan_voxels = scan.count;
  model_.row_first = rows.first;
  model_.rows = rows.count;
  model_.slice_first = slices.first;
  model_.slice_count = slices.count;
  for (const std::int64_t slice : runs.occupied()) {
    if (model_.slices.empty() || model_.slices.back().number != slice >> level)
      model_.slices.emplace_back().number = slice >> level;
  }

  // Average slices in parallel
  const std::uint64_t voxels = request.plan.volume_voxels + request.plan.hybrid_voxels;
  arena_.expect((voxels >> (3 * level)) * static_cast<std::uint64_t>(1 + model_.emissions) * sizeof(float));
  constexpr std::size_t kSlicesAtOnce = 4;
  pool.for_each((model_.slices.size() + kSlicesAtOnce - 1) / kSlicesAtOnce, [&](std::size_t job) {
    SliceAverager averager(request, level, model_);
    const std::size_t end = std::min(model_.slices.size(), (job + 1) * kSlicesAtOnce);
    for (std::size_t n = job * kSlicesAtOnce; n < end; ++n) {
      SliceSpans& slice = model_.slices[n];
      check_task();
      slice.optics = arena_.lend(averager.gather(slice.number));
      averager.write(slice);
      arena_.settle(slice.optics);
    }
  });
  for (const SliceSpans& slice : model_.slices) {
    model_.voxels += slice.voxels;
    model_.shaded_voxels += slice.shaded.size();
  }
}

void CoarseSpans::light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool) {
  if (lit_for_ && have_same_lighting(*lit_for_, view)) return;
  if (model_.shaded_voxels > 0) shade_spans(model_, lighting.table(), pool);
  lit_for_ = view;
}

}  // namespace splatlas
