#include "player/render/sheets/span_depths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "player/render/clip/clip_slabs.h"
#include "player/render/sheets/footprint_window.h"

namespace splatlas {
namespace {

constexpr auto kHalf = static_cast<float>(std::numbers::ln2);  // optical depth at a transmittance of 1/2
constexpr float kNowhere = DepthMap::kBackground;
constexpr std::size_t kRowsPerJob = 8;

/// Positions along the principal axis of a transmittance of 1/2, for the rays of a sheet of one pixel per
/// voxel.
class SheetDepths {
 public:
  /// Covers the rays of the window.
  SheetDepths(const Shear& shear, const SheetWindow& window, std::span<const VoxelPlane> planes)
      : shear_(shear), window_(window), columns_(window.columns) {
    for (const VoxelPlane& plane : planes) planes_.emplace_back(plane, shear);
  }

  void find(const SheetSpans& spans, ThreadPool& pool) {
    places_.assign(static_cast<std::size_t>(window_.rows) * static_cast<std::size_t>(columns_), kNowhere);
    const auto rows = static_cast<std::size_t>(window_.rows);
    const auto find_rows = [&](const SpanModel& model, std::size_t job) {
      std::vector<float> depths(static_cast<std::size_t>(columns_));
      std::vector<float> mixed(static_cast<std::size_t>(columns_ + 3 * kBlock));
      std::vector<KeptPart> kept;
      const std::size_t end = std::min(rows, (job + 1) * kRowsPerJob);
      for (std::size_t row = job * kRowsPerJob; row < end; ++row) {
        find_row(model, static_cast<std::int64_t>(row), depths, mixed, kept);
      }
    };
    spans.for_each_strip(shear_, window_.v0, (rows + kRowsPerJob - 1) / kRowsPerJob, kRowsPerJob,
                         [&](const SpanModel& model, std::size_t first, std::size_t last) {
                           pool.for_each(last - first, [&](std::size_t n) { find_rows(model, first + n); });
                         });
  }

  /// Position at (u, v), bilinear, in voxels; kNowhere if any of the four neighbours has none.
  [[nodiscard]] float at(double u, double v) const {
    const double column = std::floor(u), row = std::floor(v);
    const std::int64_t c = static_cast<std::int64_t>(column) - window_.u0;
    const std::int64_t r = static_cast<std::int64_t>(row) - window_.v0;
    if (c < 0 || r < 0 || c + 1 >= columns_ || r + 1 >= window_.rows) return kNowhere;
    const float* upper = &places_[static_cast<std::size_t>(r * columns_ + c)];
    const float* lower = upper + columns_;
    const auto right = static_cast<float>(u - column), down = static_cast<float>(v - row);
    // At a silhouette, fewer neighbours would extend a depth by up to a voxel, as a step.
    if (std::max({upper[0], upper[1], lower[0], lower[1]}) == kNowhere) return kNowhere;
    const float above = upper[0] + right * (upper[1] - upper[0]);
    const float below = lower[0] + right * (lower[1] - lower[0]);
    return above + down * (below - above);
  }

 private:
  /// Kept part of a ray along the principal axis, away from the viewer, in voxels.
  struct KeptPart {
    float from = -kNowhere, to = kNowhere;
  };
  /// Clips the rays of a row of the sheet; no parts without a cut.
  void clip_row(std::int64_t row, std::vector<KeptPart>& kept) const {
    kept.clear();
    if (planes_.empty()) return;
    const double sign = shear_.ascending ? 1 : -1;
    for (std::int64_t column = 0; column < columns_; ++column) {
      KeptPart part;
      for (const ShearedPlane& plane : planes_) {
        const double at = plane.at_origin + plane.per_u * static_cast<double>(column + window_.u0) +
                          plane.per_v * static_cast<double>(row + window_.v0);
        const double along = sign * plane.per_k;
        if (along == 0) {
          if (at > 0) part.to = -kNowhere;
          continue;
        }
        const auto crossed = static_cast<float>(
            std::clamp(-at / along, -static_cast<double>(kNowhere), static_cast<double>(kNowhere)));
        if (along < 0) {
          part.from = std::max(part.from, crossed);
        } else {
          part.to = std::min(part.to, crossed);
        }
      }
      kept.push_back(part);
    }
  }

  /// Traverses all slices for one row of the sheet, front to back.
  void find_row(const SpanModel& model, std::int64_t row, std::vector<float>& depths,
                std::vector<float>& mixed, std::vector<KeptPart>& kept) {
    std::fill(depths.begin(), depths.end(), 0.0f);
    clip_row(row, kept);
    float* places = &places_[static_cast<std::size_t>(row * columns_)];
    const std::size_t count = model.slices.size();
    for (std::size_t n = 0; n < count; ++n) {
      const SliceSpans& slice = model.slices[shear_.ascending ? n : count - 1 - n];
      if (slice.spans.empty()) continue;
      const auto k = static_cast<double>(slice.number);
      const double v = static_cast<double>(row + window_.v0) - shear_.v_shift(k);
      const double above = std::floor(v);
      const auto upper = static_cast<std::int64_t>(above);
      std::int64_t from = 0, to = 0;
      mix_rows(slice, upper, static_cast<float>(v - above), mixed, from, to);
      if (from < to) accumulate_slice(k, mixed, from, to, kept, depths, places);
    }
  }

  /// Interpolates the extinctions of two voxel rows, for voxels [from, to) of the scanline and a block of
  /// zeros on either side.
  void mix_rows(const SliceSpans& slice, std::int64_t upper, float lower_share, std::vector<float>& mixed,
                std::int64_t& from, std::int64_t& to) const {
    // Find the extent of both rows' spans
    const std::array<std::span<const Span>, 2> rows{slice.row(upper), slice.row(upper + 1)};
    from = std::numeric_limits<std::int64_t>::max();
    to = 0;
    for (const auto& spans : rows) {
      if (spans.empty()) continue;
      from = std::min<std::int64_t>(from, spans.front().first_block * kBlock);
      to =
          std::max<std::int64_t>(to, (std::int64_t{spans.back().first_block} + spans.back().blocks) * kBlock);
    }
    if (from >= to) return;

    // Add the weighted extinctions
    const auto needed = static_cast<std::size_t>(to - from + 2 * kBlock);
    if (mixed.size() < needed) mixed.resize(needed);
    std::fill_n(mixed.begin(), needed, 0.0f);
    for (std::size_t side = 0; side < 2; ++side) {
      const float share = side == 0 ? 1 - lower_share : lower_share;
      for (const Span& span : rows[side]) {
        float* out = &mixed[static_cast<std::size_t>(span.first_block * kBlock - from + kBlock)];
        const float* optics = slice.optics.data() + std::int64_t{span.offset} * slice.block_floats();
        for (std::uint32_t block = 0; block < span.blocks; ++block, out += kBlock) {
          for (std::int64_t i = 0; i < kBlock; ++i) out[i] += share * optics[i];
          optics += slice.block_floats();
        }
      }
    }
  }

  /// Adds the optical depths of a slab, and stores the position of rays that reach a transmittance of 1/2 in
  /// it.
  void accumulate_slice(double k, const std::vector<float>& mixed, std::int64_t from, std::int64_t to,
                        const std::vector<KeptPart>& kept, std::vector<float>& depths, float* places) const {
    // Clip the columns to the voxels: column c interpolates at voxel c + u0 - u_shift
    const double shift = static_cast<double>(window_.u0) - shear_.u_shift(k);
    const double whole = std::floor(shift);
    const auto right_share = static_cast<float>(shift - whole);
    const auto offset = static_cast<std::int64_t>(whole);
    const std::int64_t first = std::max<std::int64_t>(0, from - 1 - offset);
    const std::int64_t last = std::min(columns_, to - offset);
    const auto slab = static_cast<float>(shear_.slab_mm);
    const float sign = shear_.ascending ? 1 : -1;
    const auto place = static_cast<float>(k);
    if (first >= last) return;

    // Accumulate optical depth per column
    const float* voxels = &mixed[static_cast<std::size_t>(first + offset - from + kBlock)];
    float* sum = &depths[static_cast<std::size_t>(first)];
    places += first;
    if (!kept.empty()) {
      const KeptPart* of_ray = &kept[static_cast<std::size_t>(first)];
      for (std::int64_t c = 0; c < last - first; ++c) {
        const float begin = std::max(sign * place - 0.5f, of_ray[c].from);
        const float length = std::min(sign * place + 0.5f, of_ray[c].to) - begin;
        if (!(length > 0)) continue;
        const float before = sum[c];
        const float added = length * slab * (voxels[c] + right_share * (voxels[c + 1] - voxels[c]));
        sum[c] = before + added;
        if (before < kHalf && sum[c] >= kHalf) places[c] = sign * (begin + length * (kHalf - before) / added);
      }
      return;
    }
    for (std::int64_t c = 0; c < last - first; ++c) {
      const float before = sum[c];
      const float added = slab * (voxels[c] + right_share * (voxels[c + 1] - voxels[c]));
      sum[c] = before + added;
      const float here = place + sign * ((kHalf - before) / added - 0.5f);  // unused where nothing is added
      places[c] = before < kHalf && before + added >= kHalf ? here : places[c];
    }
  }

  const Shear& shear_;
  const SheetWindow& window_;
  std::int64_t columns_;
  std::vector<ShearedPlane> planes_;
  std::vector<float> places_;
};

}  // namespace

void add_span_depths(const SheetSpans& spans, const Shear& shear, const ViewDepth& view,
                     std::span<const VoxelPlane> planes, DepthMap& depths, ThreadPool& pool) {
  const SheetWindow window = sheet_window(spans.frame(), shear, depths.size, {});
  if (window.empty()) return;
  SheetDepths sheet(shear, window, planes);
  sheet.find(spans, pool);
  const Affine2& map = shear.picture_to_sheet;
  pool.for_each(static_cast<std::size_t>(depths.size.height), [&](std::size_t row) {
    const double y = static_cast<double>(row) + 0.5;
    float* out = &depths.mm[row * static_cast<std::size_t>(depths.size.width)];
    for (int column = 0; column < depths.size.width; ++column) {
      const double x = column + 0.5;
      const float place = sheet.at(map.xx * x + map.xy * y + map.x0, map.yx * x + map.yy * y + map.y0);
      if (place == kNowhere) continue;
      const auto mm = static_cast<float>(view.mm(x, y, shear.scan.slice_axis, static_cast<double>(place)));
      out[column] = std::min(out[column], mm);
    }
  });
}

}  // namespace splatlas
