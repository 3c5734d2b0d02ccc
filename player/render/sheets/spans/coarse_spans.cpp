#include "player/render/sheets/spans/coarse_spans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/light/voxel_light.h"
#include "player/render/sheets/spans/span_writer.h"

namespace splatlas {
namespace {

/// Builds the slices of blocks, one at a time.
class SliceAverager {
 public:
  SliceAverager(const SpanModel& fine, bool shade, int level, const SpanModel& model)
      : fine_(fine),
        shade_(shade),
        level_(level),
        model_(model),
        width_(static_cast<std::size_t>(model.scan_voxels)),
        sums_(width_ * static_cast<std::size_t>(model.rows)),
        rows_(static_cast<std::size_t>(model.rows), {width_, 0}),
        lights_(width_) {}

  /// Adds up the voxels of a slice of blocks. Returns an upper bound of its floats.
  std::size_t gather(std::int64_t slice) {
    std::size_t blocks = 0;
    for (std::int64_t of = slice << level_; of < (slice + 1) << level_; ++of) {
      const SliceSpans* const voxels = fine_.slice(of);
      if (voxels == nullptr) continue;
      auto lights = voxels->lights.begin();
      for (std::int64_t row = voxels->first_row; row < voxels->last_row; ++row) {
        for (const Span& span : voxels->row(row)) {
          add(*voxels, row, span, lights);
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

  /// Adds the voxels of a span. `lights`: the first of the slice that may be the span's.
  void add(const SliceSpans& slice, std::int64_t row_of_grid, const Span& span,
           std::vector<BlockLights>::const_iterator& lights) {
    const auto row = static_cast<std::size_t>((row_of_grid >> level_) - model_.row_first);
    const std::uint32_t first = span.first_block << kBlockBits;
    for (std::uint32_t voxel = first; voxel < first + (span.blocks << kBlockBits); ++voxel) {
      const std::uint32_t lane = SliceSpans::lane_of(span, voxel);
      while (lights != slice.lights.end() && lights->block < lane >> kBlockBits) ++lights;
      const float* const optics = slice.optics.data() + slice.place(lane);
      if (optics[0] <= 0) continue;
      const std::size_t at = index(voxel);
      VoxelSums& sums = sums_[row * width_ + at];
      rows_[row] = {std::min(rows_[row].first, at), std::max(rows_[row].last, at + 1)};
      std::array<float, 3> emission{};
      for (std::size_t c = 0; c < static_cast<std::size_t>(slice.emissions); ++c)
        emission[c] = optics[(c + 1) * kBlock];
      const bool has_light = shade_ && lights != slice.lights.end() && lights->block == lane >> kBlockBits;
      sums.add(optics[0], emission, has_light ? lights->lights[lane % kBlock] : VoxelLight{}, unpacked_);
    }
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
        lights_[n] = {sums.lit > 0 ? pack_normal(sums.normal) : PackedNormal{0}, sums.lit_share()};
        writer.color(first + static_cast<std::uint32_t>(n - begin), 1, sums.color(), &lights_[n]);
      }
      begin = end;
    }
    writer.end_row(model_.row_first + static_cast<std::int64_t>(row));
    std::fill(row_sums + extent.first, row_sums + extent.last, VoxelSums{});
  }

  const SpanModel& fine_;
  const bool shade_;
  const int level_;
  const SpanModel& model_;
  const UnpackedNormals& unpacked_ = unpacked_normals();
  const std::size_t width_;      // of the box, in blocks
  std::vector<VoxelSums> sums_;  // of the slice's box; zero outside rows_
  std::vector<Extent> rows_;
  std::vector<VoxelLight> lights_;  // of a row
};

}  // namespace

CoarseSpans::CoarseSpans(const SpanModel& fine, bool shade, int level, ThreadPool& pool)
    : level_(level), shaded_(shade) {
  // Frame the blocks
  model_.axis = fine.axis;
  model_.emissions = fine.emissions;
  model_.color = fine.color;
  model_.mean_densest_per_mm = fine.mean_densest_per_mm;
  if (fine.slices.empty()) return;
  const auto frame = [level](std::int64_t first, std::int64_t count) {
    return std::pair(first >> level, ((first + count - 1) >> level) - (first >> level) + 1);
  };
  std::tie(model_.scan_first, model_.scan_voxels) = frame(fine.scan_first, fine.scan_voxels);
  std::tie(model_.row_first, model_.rows) = frame(fine.row_first, fine.rows);
  std::tie(model_.slice_first, model_.slice_count) = frame(fine.slice_first, fine.slice_count);
  for (const SliceSpans& slice : fine.slices) {
    if (model_.slices.empty() || model_.slices.back().number != slice.number >> level)
      model_.slices.emplace_back().number = slice.number >> level;
  }

  // Average slices in parallel
  arena_.expect((fine.voxels >> (3 * level)) * static_cast<std::uint64_t>(1 + model_.emissions) *
                sizeof(float));
  constexpr std::size_t kSlicesAtOnce = 4;
  pool.for_each((model_.slices.size() + kSlicesAtOnce - 1) / kSlicesAtOnce, [&](std::size_t job) {
    SliceAverager averager(fine, shade, level, model_);
    const std::size_t end = std::min(model_.slices.size(), (job + 1) * kSlicesAtOnce);
    for (std::size_t n = job * kSlicesAtOnce; n < end; ++n) {
      SliceSpans& slice = model_.slices[n];
      check_task();
      slice.optics = arena_.lend(averager.gather(slice.number));
      averager.write(slice);
      arena_.settle(slice.optics);
    }
  });
  for (const SliceSpans& slice : model_.slices) model_.voxels += slice.voxels;
}

BlockSpans::BlockSpans(std::unique_ptr<BlockVolume> volume, const Selection& selection, const Atlas& atlas)
    : volume_(std::move(volume)), appearances_(atlas) {
  appearances_.select(volume_->plan(), selection);
}

void BlockSpans::prepare(Axis axis, bool shade, ThreadPool& pool) {
  if (spans_ && model().axis == axis && shaded_ == shade) return;
  spans_.reset();
  volume_->require(axis, pool);
  if (shade) light_voxels(volume_->plan(), appearances_, volume_->classes(), grid(), volume_->cache(), pool);
  const SelectedRuns runs(volume_->plan(), volume_->classes(), volume_->cache(), axis);
  SpanBuilder spans;
  spans.build({runs, volume_->plan(), appearances_, volume_->classes(), grid(), volume_->cache(), shade},
              pool);
  scale_by_shares(spans.model(), pool);
  spans_ = std::move(spans);
  shaded_ = shade;
}

void BlockSpans::scale_by_shares(SpanModel& spans, ThreadPool& pool) const {
  const ScanOrder scan = ScanOrder::of(spans.axis);
  const Index3& size = grid().size;
  const std::array<std::int64_t, 3> steps{1, size[0], size[0] * size[1]};
  pool.for_each(spans.slices.size(), [&](std::size_t n) {
    SliceSpans& slice = spans.slices[n];
    const auto emissions = static_cast<std::size_t>(slice.emissions);
    const auto block_floats = static_cast<std::size_t>(slice.block_floats());
    std::vector<float> shares;  // by lane of the blocks of SIMD lanes
    for (std::int64_t row = slice.first_row; row < slice.last_row; ++row) {
      const std::int64_t of_row = slice.number * steps[scan.slice_axis] + row * steps[scan.row_axis];
      for (const Span& span : slice.row(row)) {
        const std::int64_t first = std::int64_t{span.first_block} << kBlockBits;
        shares.resize((std::size_t{span.offset} + span.blocks) * kBlock, 0);
        for (std::int64_t lane = 0; lane < std::int64_t{span.blocks} << kBlockBits; ++lane) {
          if (first + lane >= size[scan.scan_axis]) break;
          const auto at = static_cast<std::size_t>(of_row + (first + lane) * steps[scan.scan_axis]);
          shares[std::size_t{span.offset} * kBlock + static_cast<std::size_t>(lane)] = volume_->share(at);
        }
      }
    }
    for (std::size_t lane = 0; lane < shares.size(); ++lane) {
      float* const optics = slice.optics.data() + lane / kBlock * block_floats + lane % kBlock;
      for (std::size_t c = 0; c <= emissions; ++c) optics[c * kBlock] *= shares[lane];
    }
  });
}

}  // namespace splatlas
