#include "bench/experiments/walked_spans.h"

namespace splatlas {

std::vector<std::uint32_t> draws_by_class(const DrawPlan& plan, std::size_t classes) {
  std::vector<std::uint32_t> draws(classes, kNotDrawn);
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    if (draws_volume(plan.classes[n].role)) draws[plan.classes[n].id] = n;
  }
  return draws;
}

WalkedSlice::WalkedSlice(const WalkedScene& scene, Axis axis, std::int64_t slice, int emissions,
                         SliceSpans& out)
    : scene_(scene),
      scan_(ScanOrder::of(axis)),
      step_{1, static_cast<std::size_t>(scene.grid.size[0]),
            static_cast<std::size_t>(scene.grid.size[0] * scene.grid.size[1])},
      first_(static_cast<std::size_t>(slice) * step_[scan_.slice_axis]),
      writer_(emissions, out) {}

void WalkedSlice::take(const WalkedRun& run) {
  if (run.row == whole_.row && run.start == whole_.start + whole_.length && run.draw == whole_.draw) {
    whole_.length += run.length;
    return;
  }
  write();
  if (run.row != whole_.row) writer_.end_row(whole_.row);
  whole_ = run;
}

IndexBox WalkedSlice::finish() {
  write();
  writer_.end_row(whole_.row);
  writer_.finish();
  return taken_;
}

void WalkedSlice::write() {
  if (whole_.length == 0) return;
  const auto& [row, start, length, draw] = whole_;
  const std::size_t voxel = first_ + row * step_[scan_.row_axis] + start * step_[scan_.scan_axis];
  const VolumeAppearance& appearance = scene_.appearances[draw];
  writer_.add(start, length);
  appearance.look_up(scene_.values, voxel, step_[scan_.scan_axis], length, writer_.extinctions(start),
                     writer_.whites(start));
  writer_.color(start, length, appearance.color);
  taken_.include(IndexBox{{row, start, 0}, {row, start + length - 1, 0}});
}

void complete(SpanModel& model, std::span<const IndexBox> taken) {
  IndexBox box;  // slices, rows, positions along the scanline
  for (std::size_t n = 0; n < taken.size(); ++n) {
    if (taken[n].empty()) continue;
    const auto slice = static_cast<std::int64_t>(n);
    box.include(
        IndexBox{{slice, taken[n].first[0], taken[n].first[1]}, {slice, taken[n].last[0], taken[n].last[1]}});
  }
  if (box.empty()) {
    model.slices.clear();
    return;
  }
  model.slices.erase(model.slices.begin() + box.last[0] + 1, model.slices.end());
  model.slices.erase(model.slices.begin(), model.slices.begin() + box.first[0]);
  model.slice_first = box.first[0];
  model.slice_count = box.last[0] - box.first[0] + 1;
  model.row_first = box.first[1];
  model.rows = box.last[1] - box.first[1] + 1;
  model.scan_first = box.first[2];
  model.scan_voxels = box.last[2] - box.first[2] + 1;
  for (const SliceSpans& slice : model.slices) model.voxels += slice.voxels;
}

}  // namespace splatlas
