#include "player/render/sheets/spans/block_spans.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "player/render/decode/selected_runs.h"

namespace splatlas {

BlockSpans::BlockSpans(std::unique_ptr<BlockVolume> volume, const Selection& selection, const Atlas& atlas)
    : volume_(std::move(volume)), appearances_(atlas) {
  appearances_.select(volume_->plan(), selection);
}

void BlockSpans::prepare(Axis axis, bool shade, const ParallelView& view, const Lighting& lighting,
                         ThreadPool& pool) {
  if (!spans_ || model().axis != axis || shaded_ != shade) {
    spans_.reset();
    volume_->require(axis, pool);
    const SelectedRuns runs(volume_->plan(), volume_->classes(), volume_->cache(), axis);
    SpanBuilder spans;
    spans.build({runs, volume_->plan(), appearances_, volume_->classes(), grid(), volume_->cache(), shade},
                pool);
    scale_by_shares(spans.model(), pool);
    spans_ = std::move(spans);
    shaded_ = shade;
    lit_for_.reset();
  }
  if (!shade || (lit_for_ && have_same_lighting(*lit_for_, view))) return;
  lit_for_.reset();  // in case the task is cancelled
  forget_light(spans_->model());
  light_spans(spans_->model(), lighting.table(), pool);
  lit_for_ = view;
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
    for (const LitRun& run : slice.lit.runs) {
      for (std::uint32_t lit = 0; lit < run.count; ++lit)
        slice.lit.voxels[run.first + lit].white *= shares[run.number + lit];
    }
  });
}

}  // namespace splatlas
