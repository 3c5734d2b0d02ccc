#include "player/render/sheets/sheets.h"

#include <algorithm>
#include <vector>

#include "player/render/clip/clip_slabs.h"
#include "player/render/sheets/band.h"
#include "player/render/sheets/band_clip.h"
#include "player/render/sheets/ids/sheet_shares.h"

namespace splatlas {
namespace {

constexpr std::int64_t kMaxBandRows = 16;  // in voxels; small enough for load balance
/// Maximum size of a band's accumulation buffer, which should fit the L2 cache.
constexpr std::int64_t kBandBytes = std::int64_t{1} << 18;

/// Makes a transparent sheet, with its border.
void begin_sheet(const SheetPass& pass, SheetImage& sheet) {
  sheet.window = pass.window;
  sheet.channels = 1 + pass.model.emissions;
  sheet.color = pass.model.color;
  const auto row_floats = static_cast<std::size_t>(sheet.stride() * sheet.channels);
  sheet.pixels.resize(static_cast<std::size_t>(pass.window.fine_rows() + 2) * row_floats);
  std::fill_n(sheet.pixels.begin(), row_floats, 0.0f);
  std::fill_n(sheet.pixels.end() - static_cast<std::ptrdiff_t>(row_floats), row_floats, 0.0f);
}

/// Number of voxels, in the rows that overlap the window, of spans that are not removed as a whole.
template <class Clip>
std::uint64_t count_voxels(const SheetPass& pass, const Clip& clip) {
  std::uint64_t voxels = 0;
  for (const SliceSpans& slice : pass.model.slices) {
    if (slice.spans.empty()) continue;
    const SliceRows rows(pass.shear, pass.window, static_cast<double>(slice.number));
    // The footprint of a voxel row extends to its neighbours: include one row on either side.
    const std::int64_t first = rows.upper_from(pass.window.scale - 1, 0);
    const std::int64_t last = rows.upper_from(0, pass.window.fine_rows()) + 1;
    if (clip.keeps_slices() && first <= slice.first_row && last >= slice.last_row) {
      voxels += slice.voxels;
      continue;
    }
    for (std::int64_t row = std::max(first, slice.first_row); row < std::min(last, slice.last_row); ++row) {
      const auto [begin, end] = clip.visible_voxels(slice, row);
      for (const Span& span : slice.row(row)) {
        const std::int64_t voxel = std::int64_t{span.first_block} * kBlock;
        if (voxel < end && voxel + std::int64_t{span.blocks} * kBlock > begin) voxels += span.voxels;
      }
    }
  }
  return voxels;
}

/// Renders the bands in parallel. Returns the number of splatted voxels.
template <class Trace, class Clip>
std::uint64_t render_bands(const SheetPass& pass, const Clip& clip, typename Trace::Frame& frame,
                           FragmentOrder& order, SheetImage& sheet, ThreadPool& pool) {
  // Split the window into bands
  const SheetWindow& window = pass.window;
  const std::int64_t row_bytes =
      BandImage::stride(window) * window.scale * window.scale * sheet.channels * std::int64_t{sizeof(float)};
  const std::int64_t band_rows =
      std::clamp<std::int64_t>(kBandBytes / std::max<std::int64_t>(row_bytes, 1), 1, kMaxBandRows);
  std::vector<SheetFragments> fragments;
  for (std::int64_t row = 0; row < window.rows; row += band_rows) {
    const std::int64_t last = std::min(row + band_rows, window.rows);
    fragments.emplace_back(order, row * window.scale, last * window.scale, window, pass.model.color);
  }
  frame.begin(window, band_rows);

  pool.for_each(fragments.size(), [&](std::size_t n) {
    // Reuse memory: page faults would cost more than the band
    static thread_local std::vector<float> floats;
    static thread_local Trace trace;
    const std::int64_t first = static_cast<std::int64_t>(n) * band_rows;
    BandImage image(window, pass.model.emissions, first, std::min(first + band_rows, window.rows), floats);
    trace.begin(frame, pass.shear, window, image, n);
    Band(pass, clip, trace, image, fragments[n]).render();
    image.store(sheet);
  });
  for (SheetFragments& of_band : fragments) of_band.merge();
  frame.finish(order);
  return count_voxels(pass, clip);
}

}  // namespace

std::uint64_t render_sheets(const SpanModel& model, const Shear& shear, const SheetWindow& window,
                            const SplatKernels& kernels, float termination_threshold,
                            std::span<const VoxelPlane> planes, FragmentOrder& fragments, SheetImage& image,
                            ThreadPool& pool, SharePass* shares) {
  const SheetPass pass{model, shear, window, kernels, termination_threshold, fragments};
  begin_sheet(pass, image);
  const auto render = [&](const auto& clip) {
    NoTrace::Frame none;
    return shares == nullptr ? render_bands<NoTrace>(pass, clip, none, fragments, image, pool)
                             : render_bands<BandShares>(pass, clip, *shares, fragments, image, pool);
  };
  if (planes.empty()) return render(NoClip());
  const ClipSlabs slabs(planes, shear, window, ImageRows::kMargin);
  return render(BandClip(slabs, window.scale));
}

}  // namespace splatlas
