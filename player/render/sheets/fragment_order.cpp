#include "player/render/sheets/fragment_order.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "player/render/view/sheet_window.h"

namespace splatlas {
namespace {

/// Parallel tasks per frame; the result is independent of their number.
constexpr std::size_t kChunks = 32, kSamplesPerJob = 4096;
/// Lower bound of transmittance. With a float resolution of 6e-8 it limits the error of the radiance in front
/// of a fragment to 1e-5.
constexpr float kMinTransmittance = 2e-4f;

/// Rows with fewer fragments are sorted without a table of the slabs.
constexpr std::size_t kMaxSlabsPerFragment = 64;

/// `width`: columns of the picture.
FragmentOrder::SheetPlace place_of(const Sample& sample, const Affine2& map, const SheetWindow& window,
                                   int width) {
  const auto columns = static_cast<double>(window.fine_columns());
  const auto rows = static_cast<double>(window.fine_rows());
  // Warp picture coordinates to sheet pixels
  const double x = sample.x(width), y = sample.y(width);
  const double sheet_x = (map.xx * x + map.xy * y + map.x0 - static_cast<double>(window.u0)) * window.scale;
  const double sheet_y = (map.yx * x + map.yy * y + map.y0 - static_cast<double>(window.v0)) * window.scale;
  if (!(sheet_x >= -1 && sheet_y >= -1 && sheet_x < columns && sheet_y < rows)) return {};

  // Find the upper left neighbour and the interpolation weights
  const double column = std::floor(sheet_x);
  const double row = std::floor(sheet_y);
  const auto right = static_cast<float>(sheet_x - column);
  FragmentOrder::SheetPlace place;
  place.row = static_cast<std::int32_t>(row);
  const auto pixel = static_cast<std::int32_t>(column);
  place.column = pixel < 0 ? -1 : pixel / window.scale;
  place.phase = pixel - place.column * window.scale;
  place.weights = sheet_weights(right, static_cast<float>(sheet_y - row), window.skew);
  if (pixel < 0) place.weights[0] = place.weights[2] = 0;
  if (column + 1 >= columns) place.weights[1] = place.weights[3] = 0;
  return place;
}

}  // namespace

float share_of_slab(float absorbed, float part) {
  if (!(absorbed > 0) || part >= 1) return std::min(part, 1.0f);
  if (absorbed < 0.125f) {
    // Sum the binomial series, with a truncation error below 1e-7
    float share = 1 + absorbed * (5 - part) * (1.0f / 6);
    share = 1 + absorbed * (4 - part) * (1.0f / 5) * share;
    share = 1 + absorbed * (3 - part) * (1.0f / 4) * share;
    share = 1 + absorbed * (2 - part) * (1.0f / 3) * share;
    share = 1 + absorbed * (1 - part) * (1.0f / 2) * share;
    return part * share;
  }
  if (absorbed >= 1) return part > 0 ? 1.0f : 0.0f;
  return -std::expm1(part * std::log1p(-absorbed)) / absorbed;
}

float share_in_slab(float before, float behind, float part) {
  const float transmittance = 1 - before, added = behind - before;
  if (!(added > 0)) return 0;
  // Limit the opacity of the slab: rounding leaves too few digits of the transmittance behind it.
  const float max_added = transmittance - kMinTransmittance;
  return share_of_slab(std::min(added, std::max(max_added, 0.0f)) / transmittance, part);
}

void FragmentOrder::build(const FragmentList& list, const Shear& shear, const SheetWindow& window,
                          const PictureSize& size, const Grid& grid, ThreadPool& pool) {
  ascending_ = shear.ascending;
  slices_ = grid.size[shear.scan.slice_axis];
  slabs_ = Slabs::of(slices_, window.parts);
  const std::int64_t fine_rows = window.empty() ? 0 : window.fine_rows();
  first_of_row_.assign(static_cast<std::size_t>(fine_rows) + 2, 0);
  place_.resize(list.fragments.size());
  if (window.empty() || list.fragments.empty()) {
    std::fill(place_.begin(), place_.end(), kNowhere);
    entries_.clear();
    radiance_.clear();
    return;
  }
  samples_.resize(list.sample_count());
  const std::size_t jobs = (samples_.size() + kSamplesPerJob - 1) / kSamplesPerJob;
  pool.for_each(jobs, [&](std::size_t job) {
    const std::size_t end = std::min(samples_.size(), (job + 1) * kSamplesPerJob);
    for (std::size_t n = job * kSamplesPerJob; n < end; ++n)
      samples_[n] = place_of(list.samples[n], shear.picture_to_sheet, window, size.width);
  });
  scatter(list, pool);
  entries_.resize(unsorted_.size());
  radiance_.resize(unsorted_.size());
  const std::size_t rows = first_of_row_.size() - 1;
  const std::size_t rows_per_chunk = (rows + kChunks - 1) / kChunks;
  pool.for_each((rows + rows_per_chunk - 1) / rows_per_chunk, [&](std::size_t chunk) {
    std::vector<std::uint32_t> next_of_slab;
    const std::size_t first = chunk * rows_per_chunk;
    for (std::size_t n = first; n < std::min(first + rows_per_chunk, rows); ++n) sort_row(n, next_of_slab);
  });
}

/// Counting sort of the fragments by row of the sheet; within a row they keep the order of the picture.
void FragmentOrder::scatter(const FragmentList& list, ThreadPool& pool) {
  const std::size_t rows = first_of_row_.size() - 1;
  const std::size_t samples_per_chunk = (list.sample_count() + kChunks - 1) / kChunks;
  const std::size_t chunks = (list.sample_count() + samples_per_chunk - 1) / samples_per_chunk;
  const auto for_each_sample = [&](std::size_t chunk, const auto& body) {
    const std::size_t first = chunk * samples_per_chunk;
    for (std::size_t n = first; n < std::min(first + samples_per_chunk, list.sample_count()); ++n) body(n);
  };

  // Count fragments per chunk and row
  std::vector<std::vector<std::size_t>> next_of_row(chunks);
  pool.for_each(chunks, [&](std::size_t chunk) {
    next_of_row[chunk].assign(rows, 0);
    for_each_sample(chunk, [&](std::size_t n) {
      const std::int64_t row = samples_[n].row;
      if (row != kNoRow) next_of_row[chunk][static_cast<std::size_t>(row + 1)] += list.of_sample(n).size();
    });
  });

  // Compute prefix sums
  std::size_t fragments = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    first_of_row_[row] = fragments;
    for (std::vector<std::size_t>& next : next_of_row) {
      const std::size_t count = next[row];
      next[row] = fragments;
      fragments += count;
    }
  }
  first_of_row_[rows] = fragments;

  // Scatter the fragments
  unsorted_.resize(fragments);
  pool.for_each(chunks, [&](std::size_t chunk) {
    for_each_sample(chunk, [&](std::size_t n) {
      const std::uint32_t first = list.samples[n].first_fragment;
      const std::uint32_t last = list.samples[n + 1].first_fragment;
      const std::int64_t row = samples_[n].row;
      if (row == kNoRow) {
        std::fill(place_.begin() + first, place_.begin() + last, kNowhere);
        return;
      }
      std::size_t& next = next_of_row[chunk][static_cast<std::size_t>(row + 1)];
      for (std::uint32_t fragment = first; fragment < last; ++fragment) {
        const auto depth = static_cast<double>(list.fragments[fragment].depth);
        unsorted_[next++] = {fragment, {slab_at(along_of_depth(depth)).slab, static_cast<std::uint32_t>(n)}};
      }
    });
  });
}

/// Sorts a row's fragments by slab, by counting unless slabs are many. Both sorts are stable.
void FragmentOrder::sort_row(std::size_t n, std::vector<std::uint32_t>& next_of_slab) {
  const std::size_t first = first_of_row_[n];
  const std::size_t last = first_of_row_[n + 1];
  if (first == last) return;
  if (static_cast<std::size_t>(slabs_.count) / kMaxSlabsPerFragment > last - first) {
    const auto row = std::span(unsorted_).subspan(first, last - first);
    std::ranges::stable_sort(row, {}, [](const Unsorted& of) { return of.entry.slab; });
    for (std::size_t e = first; e < last; ++e) put(unsorted_[e], e);
    return;
  }
  next_of_slab.assign(static_cast<std::size_t>(slabs_.count) + 1, 0);
  for (std::size_t e = first; e < last; ++e) {
    ++next_of_slab[static_cast<std::size_t>(unsorted_[e].entry.slab) + 1];
  }
  for (std::size_t slab = 1; slab < next_of_slab.size(); ++slab) {
    next_of_slab[slab] += next_of_slab[slab - 1];
  }
  for (std::size_t e = first; e < last; ++e) {
    const Unsorted& from = unsorted_[e];
    put(from, first + next_of_slab[static_cast<std::size_t>(from.entry.slab)]++);
  }
}

void FragmentOrder::put(const Unsorted& from, std::size_t to) {
  entries_[to] = from.entry;
  radiance_[to] = {};
  place_[from.fragment] = static_cast<std::uint32_t>(to);
}

FragmentOrder::SlabPlace FragmentOrder::slab_at(double along) const {
  const double slabs = (along - slabs_.begin) / slabs_.thickness;
  const double slab = std::clamp(std::floor(slabs), 0.0, static_cast<double>(slabs_.count - 1));
  return {static_cast<std::int32_t>(slab), static_cast<float>(std::clamp(slabs - slab, 0.0, 1.0))};
}

float FragmentOrder::kept_part(std::int32_t slab, double depth, const ClipDepths& kept) const {
  const double begin = slabs_.begin + slab * slabs_.thickness;
  const double from = std::max(begin, along_of_depth(kept.from));
  const double to = std::min(begin + slabs_.thickness, along_of_depth(kept.to));
  if (!(from < to)) return 0;
  return static_cast<float>(std::clamp((along_of_depth(depth) - from) / (to - from), 0.0, 1.0));
}

Radiance FragmentOrder::in_front_of(std::size_t fragment, float depth, const ClipDepths* kept) const {
  if (place_[fragment] == kNowhere) return {};
  const SlabRadiance& slab = radiance_[place_[fragment]];
  if (!(slab.behind.rgba[3] - slab.before.rgba[3] > 0)) return slab.before;
  const SlabPlace place = slab_at(along_of_depth(static_cast<double>(depth)));
  const float part = kept == nullptr ? place.part : kept_part(place.slab, static_cast<double>(depth), *kept);
  const float share = share_in_slab(slab.before.rgba[3], slab.behind.rgba[3], part);
  Radiance radiance;
  for (std::size_t c = 0; c < 4; ++c) {
    radiance.rgba[c] = slab.before.rgba[c] + share * (slab.behind.rgba[c] - slab.before.rgba[c]);
  }
  return radiance;
}

}  // namespace splatlas
