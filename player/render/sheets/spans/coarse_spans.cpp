#include "player/render/sheets/spans/coarse_spans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/light/voxel_sums.h"
#include "player/render/sheets/spans/span_writer.h"

namespace splatlas {
namespace {

/// Blocks [first, first + count) of the grid that cover voxels `from` to `to`.
struct BlockRange {
  std::int64_t first = 0, count = 0;

  BlockRange(std::int64_t from, std::int64_t to, int level)
      : first(from >> level), count((to >> level) - first + 1) {}
};

/// Builds the slices of blocks, one at a time.
class SliceAverager {
 public:
  SliceAverager(const SpanRequest& request, int level, const SpanModel& model)
      : request_(request),
        level_(level),
        model_(model),
        scan_(ScanOrder::of(model.axis)),
        width_(static_cast<std::size_t>(model.scan_voxels)),
        lighter_(request.runs, request.cache, request.grid, request.shade),
        sums_(width_ * static_cast<std::size_t>(model.rows)),
        rows_(static_cast<std::size_t>(model.rows), {width_, 0}),
        normals_(width_),
        lit_(width_) {}

  /// Adds up the voxels of a slice of blocks. Returns an upper bound of its floats.
  std::size_t gather(std::int64_t slice) {
    std::size_t blocks = 0;
    for (std::int64_t of = slice << level_; of < (slice + 1) << level_; ++of) {
      request_.runs.for_each(of, [&](const ClassRun& run, std::uint32_t draw) {
        add(of, run, draw);
        blocks += (run.length >> level_) / kBlock + 3;
      });
    }
    return blocks * kBlock * static_cast<std::size_t>(1 + model_.emissions);
  }
  /// The same from the spans of the voxels.
  std::size_t gather(std::int64_t slice, const SpanModel& fine) {
    std::size_t blocks = 0;
    for (std::int64_t of = slice << level_; of < (slice + 1) << level_; ++of) {
      const SliceSpans* const voxels = fine.slice(of);
      if (voxels == nullptr) continue;
      LitCursor lit(voxels->lit);
      for (std::int64_t row = voxels->first_row; row < voxels->last_row; ++row) {
        for (const Span& span : voxels->row(row)) {
          add(*voxels, row, span, lit);
          blocks += (std::size_t{span.blocks} >> level_) + 3;
        }
      }
    }
    return blocks * kBlock * static_cast<std::size_t>(1 + model_.emissions);
  }
  /// Writes the slice, and clears its sums.
  void write(SliceSpans& out) {
    SpanWriter writer(model_.emissions, out);
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      if (rows_[row].first < rows_[row].last) write_row(row, writer);
    }
    writer.finish();
  }

 private:
  /// Blocks [first, last) of a row that have sums.
  struct Extent {
    std::size_t first = 0, last = 0;
  };

  /// Adds the voxels of a run to the sums of their blocks.
  void add(std::int64_t slice, const ClassRun& run, std::uint32_t draw) {
    constexpr std::uint32_t kAtOnce = 256;
    const VolumeAppearance& look = request_.appearances.appearances()[draw];
    const VoxelLight light =
        lighter_.light(look, request_.plan.classes[draw].boundary, slice, run.row, run.start, run.length);
    const std::size_t row = static_cast<std::size_t>((std::int64_t{run.row} >> level_) - model_.row_first);
    VoxelSums* const row_sums = sums_.data() + row * width_;
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
        VoxelSums& sums = row_sums[index(run.start + done + n)];
        sums.extinction += extinctions[n];
        sums.weight += whites[n];
        for (std::size_t c = 0; c < 3; ++c) sums.emission[c] += whites[n] * look.color[c];
        const float lit = whites[n] * share_of(light, done + n);
        if (lit != 0) sums.add_light(lit, light.normals[(done + n) * light.stride], unpacked_);
      }
      voxel += count * step;
    }
    rows_[row].first = std::min(rows_[row].first, index(run.start));
    rows_[row].last = std::max(rows_[row].last, index(run.start + run.length - 1) + 1);
  }
  /// Adds the voxels of a span. `lit`: of the slice.
  void add(const SliceSpans& slice, std::int64_t row_of_grid, const Span& span, LitCursor& lit) {
    const auto row = static_cast<std::size_t>((row_of_grid >> level_) - model_.row_first);
    const std::uint32_t first = span.first_block << kBlockBits;
    for (std::uint32_t voxel = first; voxel < first + (span.blocks << kBlockBits); ++voxel) {
      const std::uint32_t lane = SliceSpans::lane_of(span, voxel);
      const float* const optics = slice.optics.data() + slice.place(lane);
      if (optics[0] <= 0) continue;
      const std::size_t at = index(voxel);
      VoxelSums& sums = sums_[row * width_ + at];
      rows_[row] = {std::min(rows_[row].first, at), std::max(rows_[row].last, at + 1)};
      const LitVoxel* const is_lit = lit.find(lane);
      std::array<float, 3> emission{};
      for (std::size_t c = 0; c < static_cast<std::size_t>(slice.emissions); ++c)
        emission[c] = is_lit != nullptr ? is_lit->white * lit.color()[c] : optics[(c + 1) * kBlock];
      sums.add(optics[0], emission, request_.shade ? is_lit : nullptr, unpacked_);
    }
  }
  /// The lit share of the n-th voxel.
  static float share_of(const VoxelLight& light, std::uint32_t n) {
    if (light.normals == nullptr) return 0;
    return light.lit == nullptr ? 1 : static_cast<float>(light.lit[n]) / LitVoxel::kAllLit;
  }

  [[nodiscard]] std::size_t index(std::uint32_t voxel) const {
    return static_cast<std::size_t>((std::int64_t{voxel} >> level_) - model_.scan_first);
  }

  /// Writes the means of a row, run by run, and clears its sums.
  void write_row(std::size_t row, SpanWriter& writer) {
    const float per_voxel = std::ldexp(1.0f, -3 * level_);
    const Extent extent = std::exchange(rows_[row], {width_, 0});
    VoxelSums* const row_sums = sums_.data() + row * width_;
    for (std::size_t begin = extent.first; begin < extent.last;) {
      if (row_sums[begin].extinction <= 0) {
        ++begin;
        continue;
      }
      std::size_t end = begin;
      while (end < extent.last && row_sums[end].extinction > 0) ++end;
      const auto first = static_cast<std::uint32_t>(model_.scan_first + static_cast<std::int64_t>(begin));
      const auto count = static_cast<std::uint32_t>(end - begin);
      writer.add(first, count);
      for (std::size_t n = begin; n < end; ++n) {
        const VoxelSums& sums = row_sums[n];
        writer.extinctions(first)[n - begin] = sums.extinction * per_voxel;
        writer.whites(first)[n - begin] = sums.weight * per_voxel;
        if (sums.lit > 0) normals_[n] = pack_normal(sums.normal);
        lit_[n] = sums.lit_share();
        writer.color(first + static_cast<std::uint32_t>(n - begin), 1, sums.color(),
                     {&normals_[n], 1, &lit_[n]});
      }
      begin = end;
    }
    writer.end_row(model_.row_first + static_cast<std::int64_t>(row));
    std::fill(row_sums + extent.first, row_sums + extent.last, VoxelSums{});
  }

  const SpanRequest& request_;
  const int level_;
  const SpanModel& model_;
  const ScanOrder scan_;
  const UnpackedNormals& unpacked_ = unpacked_normals();
  const std::size_t width_;  // of the box, in blocks
  VoxelLighter lighter_;
  std::vector<VoxelSums> sums_;  // of the slice's box; zero outside rows_
  std::vector<Extent> rows_;
  std::vector<PackedNormal> normals_;  // of a row
  std::vector<std::uint16_t> lit_;
};

}  // namespace

CoarseSpans::CoarseSpans(const SpanRequest& request, const SpanModel* fine, int level, ThreadPool& pool)
    : level_(level), shaded_(request.shade) {
  // Frame the blocks
  const SelectedRuns& runs = request.runs;
  model_ = empty_model(request);
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
      slice.optics =
          arena_.lend(fine != nullptr ? averager.gather(slice.number, *fine) : averager.gather(slice.number));
      averager.write(slice);
      arena_.settle(slice.optics);
    }
  });
  for (const SliceSpans& slice : model_.slices) {
    model_.voxels += slice.voxels;
    model_.lit_voxels += slice.lit.voxels.size();
  }
}

void CoarseSpans::light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool) {
  if (lit_for_ && have_same_lighting(*lit_for_, view)) return;
  lit_for_.reset();  // in case the task is cancelled
  forget_light(model_);
  if (model_.lit_voxels > 0) light_spans(model_, lighting.table(), pool);
  lit_for_ = view;
}

}  // namespace splatlas
