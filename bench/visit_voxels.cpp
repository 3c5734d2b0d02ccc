#include "bench/visit_voxels.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace splatlas {
namespace {

/// A selected voxel that absorbs.
struct VisibleVoxel {
  std::uint32_t at = 0;    // along the scanline
  std::uint32_t draw = 0;  // index into the plan's classes
  VoxelLook look;
  std::size_t voxel = 0;  // in memory
};

/// One slice: first the visible voxels, row by row, then their spans.
class SliceVisit {
 public:
  SliceVisit(const VoxelModel& model, const VoxelSelection& selection, const ScanOrder& scan)
      : model_(model), selection_(selection), scan_(scan), rows_(model.grid.size[scan.row_axis]) {
    const Index3& size = model.grid.size;
    step_ = {1, static_cast<std::size_t>(size[0]), static_cast<std::size_t>(size[0] * size[1])};
    looks_.resize(static_cast<std::size_t>(size[scan.scan_axis]));
  }

  /// Spans with one entry of `first_span` per row of the grid.
  SliceSpans visit(std::int64_t slice, int emissions) {
    for (std::int64_t row = 0; row < rows_; ++row) {
      first_visible_.push_back(visible_.size());
      visit_row(slice, row);
    }
    first_visible_.push_back(visible_.size());
    return pack(emissions);
  }

  /// Of the selected voxels, visible or not: rows in [0], positions along the scanline in [1].
  [[nodiscard]] const IndexBox& selected() const { return selected_; }

 private:
  [[nodiscard]] std::uint32_t draw_of(std::size_t voxel) const {
    return selection_.draw_of_class[model_.classes[voxel]];
  }

  void visit_row(std::int64_t slice, std::int64_t row) {
    const std::size_t start = static_cast<std::size_t>(slice) * step_[scan_.slice_axis] +
                              static_cast<std::size_t>(row) * step_[scan_.row_axis];
    const std::size_t step = step_[scan_.scan_axis];
    for (std::size_t n = 0; n < looks_.size(); ++n) {
      const std::uint32_t draw = draw_of(start + n * step);
      if (draw == VoxelSelection::kNotDrawn) continue;
      const std::size_t first = n;
      while (n + 1 < looks_.size() && draw_of(start + (n + 1) * step) == draw) ++n;
      take(row, start + first * step, first, n + 1 - first, draw);
    }
  }

  /// Looks up the grey values of `count` voxels in a row that are drawn alike, and keeps those that absorb.
  void take(std::int64_t row, std::size_t voxel, std::size_t first, std::size_t count, std::uint32_t draw) {
    const std::size_t step = step_[scan_.scan_axis];
    selected_.include(IndexBox{{row, static_cast<std::int64_t>(first), 0},
                               {row, static_cast<std::int64_t>(first + count) - 1, 0}});
    selection_.looks[draw].look_up(model_.values.bytes.data(), voxel, step, count, looks_.data());
    for (std::size_t n = 0; n < count; ++n) {
      if (looks_[n].extinction_per_mm <= 0) continue;
      visible_.push_back({static_cast<std::uint32_t>(first + n), draw, looks_[n], voxel + n * step});
    }
  }

  SliceSpans pack(int emissions) const {
    SliceSpans out;
    out.emissions = emissions;
    if (visible_.empty()) return out;
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows_); ++row) {
      out.first_span.push_back(static_cast<std::uint32_t>(out.spans.size()));
      const std::size_t first_of_row = out.spans.size();
      for (std::size_t n = first_visible_[row]; n < first_visible_[row + 1]; ++n) {
        out.add_voxel(first_of_row, visible_[n].at);
      }
    }
    out.first_span.push_back(static_cast<std::uint32_t>(out.spans.size()));

    out.allocate_light();
    std::size_t n = 0;
    for (const Span& span : out.spans) {
      for (std::uint32_t v = 0; v < span.voxels; ++v) light(visible_[n++], span, out);
    }
    return out;
  }

  void light(const VisibleVoxel& visible, const Span& span, SliceSpans& out) const {
    ShadedVoxel voxel = out.set_light(span, visible.at, selection_.looks[visible.draw], visible.look);
    if (!selection_.plan.classes[visible.draw].boundary) return;
    voxel.normal = model_.normals[visible.voxel];
    out.shaded.push_back(voxel);
  }

  const VoxelModel& model_;
  const VoxelSelection& selection_;
  ScanOrder scan_;
  std::int64_t rows_;
  std::array<std::size_t, 3> step_{};
  std::vector<VoxelLook> looks_;  // of one scanline
  std::vector<VisibleVoxel> visible_;
  std::vector<std::size_t> first_visible_;  // per row, and the end
  IndexBox selected_;
};

/// Cuts the model down to the box of what is selected, which is where the player's model stands.
void trim(SpanModel& model, std::span<const IndexBox> selected) {
  IndexBox box;  // slices, rows, positions along the scanline
  for (std::size_t n = 0; n < selected.size(); ++n) {
    if (selected[n].empty()) continue;
    const auto slice = static_cast<std::int64_t>(n);
    box.include(IndexBox{{slice, selected[n].first[0], selected[n].first[1]},
                         {slice, selected[n].last[0], selected[n].last[1]}});
  }
  if (box.empty()) {
    model.slices.clear();
    return;
  }
  model.slices.erase(model.slices.begin() + box.last[0] + 1, model.slices.end());
  model.slices.erase(model.slices.begin(), model.slices.begin() + box.first[0]);
  model.slice_first = box.first[0];
  model.row_first = box.first[1];
  model.rows = box.last[1] - box.first[1] + 1;
  model.scan_first = box.first[2];
  model.scan_voxels = box.last[2] - box.first[2] + 1;
  for (SliceSpans& slice : model.slices) {
    std::vector<std::uint32_t>& first_span = slice.first_span;
    if (slice.spans.empty()) continue;
    first_span.erase(first_span.begin() + box.last[1] + 2, first_span.end());
    first_span.erase(first_span.begin(), first_span.begin() + box.first[1]);
    slice.find_rows();
  }
}

}  // namespace

SpanModel visit_voxels(const VoxelModel& model, const VoxelSelection& selection, Axis axis,
                       ThreadPool& pool) {
  const ScanOrder scan = ScanOrder::of(axis);
  const auto slices = static_cast<std::size_t>(model.grid.size[scan.slice_axis]);
  SpanModel spans;
  spans.axis = axis;
  const std::optional<std::array<float, 3>> color = common_color(selection.plan, selection.looks);
  spans.emissions = color ? 1 : 3;
  spans.color = color.value_or(spans.color);
  spans.slices.resize(slices);
  std::vector<IndexBox> selected(slices);
  pool.for_each(slices, [&](std::size_t n) {
    SliceVisit visit(model, selection, scan);
    spans.slices[n] = visit.visit(static_cast<std::int64_t>(n), spans.emissions);
    selected[n] = visit.selected();
  });
  trim(spans, selected);
  for (const SliceSpans& slice : spans.slices) {
    spans.voxels += slice.voxels;
    spans.shaded_voxels += slice.shaded.size();
  }
  return spans;
}

}  // namespace splatlas
