#include "player/render/sheets/sheet_fragments.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace splatlas {
namespace {

/// Parallel tasks per frame; the result is independent of their number.
constexpr std::size_t kChunks = 32;

/// `map`: from the picture to sheet pixels.
SheetSample place_of(double x, double y, const Affine2& map, const SheetWindow& window, std::int64_t planes,
                     std::int64_t band_rows) {
  const auto columns = static_cast<double>(window.fine_columns());
  const auto rows = static_cast<double>(window.fine_rows());
  const double sheet_x = map.xx * x + map.xy * y + map.x0, sheet_y = map.yx * x + map.yy * y + map.y0;
  const bool is_inside = sheet_x >= -1 && sheet_y >= -1 && sheet_x < columns && sheet_y < rows;
  if (!is_inside || window.empty()) return {};

  // Find the interpolation weights of the neighbours in the sheet
  const double column = std::floor(sheet_x), row = std::floor(sheet_y);
  SheetSample sample;
  sample.weights =
      sheet_weights(static_cast<float>(sheet_x - column), static_cast<float>(sheet_y - row), window.skew);
  auto& [upper_left, upper_right, lower_left, lower_right] = sample.weights;
  if (column < 0) upper_left = lower_left = 0;
  if (column + 1 >= columns) upper_right = lower_right = 0;
  if (row < 0) upper_left = lower_left, upper_right = lower_right;  // the first row is below the sample
  if (row < 0 || row + 1 >= rows) lower_left = lower_right = 0;

  // Find the upper neighbours in the band
  const auto fine_row = static_cast<std::int64_t>(std::max(row, 0.0)),
             pixel = static_cast<std::int64_t>(column);
  sample.band = static_cast<std::uint32_t>(fine_row / band_rows);
  const std::int64_t in_voxels = pixel < 0 ? -1 : pixel / window.scale;
  const std::int64_t phase = pixel - in_voxels * window.scale,
                     phase_stride = planes * BandImage::stride(window);
  const std::int64_t left = BandImage::begin_of(fine_row % band_rows, phase, window, planes) + in_voxels;
  sample.left = static_cast<std::uint32_t>(left);
  sample.right = static_cast<std::uint32_t>(phase + 1 < window.scale ? left + phase_stride
                                                                     : left - phase * phase_stride + 1);
  return sample;
}

}  // namespace

void SheetFragments::build(const FragmentList& fragments, const CutRays* cuts, const PictureSize& size,
                           const Shear& shear, const SheetWindow& window, const Slabs& slabs, int planes,
                           std::int64_t band_rows, ThreadPool& pool) {
  list_ = &fragments;
  cuts_ = cuts;
  width_ = size.width;
  slice_axis_ = shear.scan.slice_axis;
  depth_sign_ = shear.ascending ? 1 : -1;
  const std::size_t count = fragments.sample_count();
  const std::int64_t rows = window.empty() ? 0 : window.fine_rows();
  const auto bands = static_cast<std::size_t>((rows + band_rows - 1) / band_rows);
  samples_.resize(count);
  const std::size_t per_chunk = (count + kChunks - 1) / kChunks;
  const auto for_each_sample = [&](const auto& body) {
    pool.for_each(per_chunk == 0 ? 0 : (count + per_chunk - 1) / per_chunk, [&](std::size_t chunk) {
      const std::size_t end = std::min(count, (chunk + 1) * per_chunk);
      for (std::size_t n = chunk * per_chunk; n < end; ++n) body(chunk, n);
    });
  };

  // Place the samples, and count the fragments of each chunk and band
  const Affine2 map = picture_to_pixels(shear, window);
  std::vector<std::vector<std::size_t>> next_of_band(kChunks, std::vector<std::size_t>(bands, 0));
  for_each_sample([&](std::size_t chunk, std::size_t n) {
    const Sample& from = fragments.samples[n];
    SheetSample& sample = samples_[n] =
        place_of(from.x(width_), from.y(width_), map, window, planes, band_rows);
    if (sample.band != SheetSample::kNoBand) {
      next_of_band[chunk][sample.band] += fragments.of_sample(n).size();
    } else {
      for (const Fragment& fragment : fragments.of_sample(n)) sample.add(fragment, {});
    }
  });

  // Sort the fragments by band, by counting
  first_of_band_.assign(1, 0);
  std::size_t sum = 0;
  for (std::size_t band = 0; band < bands; ++band) {
    for (std::vector<std::size_t>& next : next_of_band) sum += std::exchange(next[band], sum);
    first_of_band_.push_back(sum);
  }
  entries_.resize(sum);
  for_each_sample([&](std::size_t chunk, std::size_t n) {
    if (samples_[n].band == SheetSample::kNoBand) return;
    std::size_t& next = next_of_band[chunk][samples_[n].band];
    // Coincident surfaces may be out of order by rounding
    std::int32_t slab = 0;
    for (std::uint32_t f = fragments.samples[n].first_fragment; f < fragments.samples[n + 1].first_fragment;
         ++f) {
      const Slabs::Place place = slabs.place_of(static_cast<double>(fragments.fragments[f].depth));
      slab = std::max(slab, place.slab);
      entries_[next++] = {f, static_cast<std::uint32_t>(n), slab, place.slab < slab ? 0 : place.part};
    }
  });
}

float SheetFragments::kept_part(const Entry& of, const Slabs& slabs) const {
  if (cuts_ == nullptr) return of.part;
  const Sample& sample = list_->samples[of.sample];
  const ClipDepths kept = cuts_->depths(sample.x(width_), sample.y(width_), slice_axis_, depth_sign_);
  return slabs.kept_part(of.slab, static_cast<double>(list_->fragments[of.fragment].depth), kept.from,
                         kept.to);
}

void BandFragments::begin(SheetFragments& fragments, std::size_t band, const Slabs& slabs,
                          const BandImage& image, const std::array<float, 3>& color) {
  all_ = &fragments;
  slabs_ = &slabs;
  pixels_ = image.begin();
  planes_ = image.planes();
  plane_stride_ = image.plane_stride();
  row_stride_ = image.row_stride();
  color_ = color;
  next_ = 0;

  // Sort the fragments by slab, by counting
  const auto of_band = std::span(fragments.entries_)
                           .subspan(fragments.first_of_band_[band],
                                    fragments.first_of_band_[band + 1] - fragments.first_of_band_[band]);
  begin_of_slab_.assign(static_cast<std::size_t>(slabs.count()) + 2, 0);
  for (const SheetFragments::Entry& entry : of_band)
    ++begin_of_slab_[static_cast<std::size_t>(entry.slab) + 2];
  for (std::size_t n = 2; n < begin_of_slab_.size(); ++n) begin_of_slab_[n] += begin_of_slab_[n - 1];
  entries_.resize(of_band.size());
  for (const SheetFragments::Entry& entry : of_band)
    entries_[begin_of_slab_[static_cast<std::size_t>(entry.slab) + 1]++] = entry;
}

void BandFragments::before_slab(std::int32_t slab) {
  // Nothing is splatted between the last slab and the fragments in front of this one
  for (; next_ < begin_of_slab_[static_cast<std::size_t>(slab)]; ++next_) {
    SheetSample& sample = all_->samples_[entries_[next_].sample];
    sample.add(all_->list_->fragments[entries_[next_].fragment], radiance_at(sample));
  }
  in_front_.clear();
  for (std::size_t n = next_; n < begin_of_slab_[static_cast<std::size_t>(slab) + 1]; ++n) {
    __builtin_prefetch(&all_->list_->fragments[entries_[n].fragment]);  // for behind_slab()
    in_front_.push_back(radiance_at(all_->samples_[entries_[n].sample]));
  }
}

void BandFragments::behind_slab() {
  for (Radiance& radiance : in_front_) {
    const SheetFragments::Entry& entry = entries_[next_++];
    SheetSample& sample = all_->samples_[entry.sample];
    const Radiance behind = radiance_at(sample);
    if (behind.rgba[3] > radiance.rgba[3]) {
      // The properties of a slab are constant
      const float share = share_in_slab(radiance.rgba[3], behind.rgba[3], all_->kept_part(entry, *slabs_));
      for (std::size_t c = 0; c < 4; ++c) radiance.rgba[c] += share * (behind.rgba[c] - radiance.rgba[c]);
    }
    sample.add(all_->list_->fragments[entry.fragment], radiance);
  }
  in_front_.clear();
}

Radiance BandFragments::radiance_at(const SheetSample& sample) const {
  const float opacity = plane_at(sample, planes_ - 1);
  if (opacity == sample.volume.rgba[3]) return sample.volume;  // as nothing was added
  if (planes_ == 2) return in_color(plane_at(sample, 0), opacity, color_);
  return {{plane_at(sample, 0), plane_at(sample, 1), plane_at(sample, 2), opacity}};
}

}  // namespace splatlas
