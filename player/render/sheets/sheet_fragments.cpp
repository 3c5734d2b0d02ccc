#include "player/render/sheets/sheet_fragments.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace splatlas {
namespace {

/// Parallel tasks per frame; the result is independent of their number.
constexpr std::size_t kChunks = 32;
/// Bands with fewer fragments are sorted without a table of the slabs.
constexpr std::size_t kMaxSlabsPerFragment = 64;

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

  // Sort the fragments by slab, by counting unless slabs are many
  const auto of_band = std::span(fragments.entries_)
                           .subspan(fragments.first_of_band_[band],
                                    fragments.first_of_band_[band + 1] - fragments.first_of_band_[band]);
  entries_.assign(of_band.begin(), of_band.end());
  if (static_cast<std::size_t>(slabs.count()) / kMaxSlabsPerFragment > of_band.size()) {
    std::ranges::stable_sort(entries_, {}, &SheetFragments::Entry::slab);
    return;
  }
  next_of_slab_.assign(static_cast<std::size_t>(slabs.count()) + 1, 0);
  for (const SheetFragments::Entry& entry : of_band)
    ++next_of_slab_[static_cast<std::size_t>(entry.slab) + 1];
  for (std::size_t n = 1; n < next_of_slab_.size(); ++n) next_of_slab_[n] += next_of_slab_[n - 1];
  for (const SheetFragments::Entry& entry : of_band)
    entries_[next_of_slab_[static_cast<std::size_t>(entry.slab)]++] = entry;
}

void BandFragments::before_slab(std::int32_t slab) {
  // Nothing is splatted between the last slab and the fragments in front of this one
  for (; next_ < entries_.size() && entries_[next_].slab < slab; ++next_) {
    SheetSample& sample = all_->samples_[entries_[next_].sample];
    sample.add(all_->list_->fragments[entries_[next_].fragment], radiance_at(sample));
  }
  in_front_.clear();
  for (std::size_t n = next_; n < entries_.size() && entries_[n].slab == slab; ++n) {
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

void SheetEnds::build(std::span<const float> depths, const PictureSize& size, const Shear& shear,
                      const SheetWindow& window, const Slabs& slabs, ThreadPool& pool) {
  // Invert the map from the picture to the sheet
  const Affine2& map = shear.picture_to_sheet;
  const double determinant = map.xx * map.yy - map.xy * map.yx;
  const double last_x = size.width - 1, last_y = size.height - 1;
  const auto rows = static_cast<std::size_t>(window.empty() ? 0 : window.fine_rows());
  rows_.resize(rows);
  constexpr std::size_t kRowsPerJob = 16;
  pool.for_each((rows + kRowsPerJob - 1) / kRowsPerJob, [&](std::size_t job) {
    for (std::size_t row = job * kRowsPerJob; row < std::min(rows, (job + 1) * kRowsPerJob); ++row) {
      rows_[row].clear();
      const double v = static_cast<double>(window.v0) + static_cast<double>(row) / window.scale - map.y0;
      for (std::int64_t fine = 0; fine < window.fine_columns(); ++fine) {
        const double u = static_cast<double>(window.u0) + static_cast<double>(fine) / window.scale - map.x0;
        const double x = std::clamp(std::floor((map.yy * u - map.xy * v) / determinant), 0.0, last_x);
        const double y = std::clamp(std::floor((map.xx * v - map.yx * u) / determinant), 0.0, last_y);
        const float depth = depths[size.pixel(static_cast<int>(x), static_cast<int>(y))];
        if (!std::isfinite(depth)) continue;
        const Slabs::Place place = slabs.place_of(static_cast<double>(depth));
        rows_[row].push_back({place.slab, static_cast<std::int32_t>(fine / window.scale),
                              static_cast<std::int32_t>(fine % window.scale), place.part});
      }
    }
  });
}

BandEnds::BandEnds(const SheetEnds& ends, BandImage& image)
    : planes_(image.planes()), plane_stride_(image.plane_stride()) {
  for (std::int64_t fine_row = image.first_fine_row(); fine_row < image.last_fine_row(); ++fine_row) {
    for (const SheetEnds::End& end : ends.of_row(fine_row))
      all_.push_back({end, image.rows(fine_row, end.phase).pixels + end.column, {}});
  }
  std::ranges::sort(all_, {}, [](const Ended& of) { return of.end.slab; });
}

/// Ends in front of `slab` are passed; those in it wait for its end.
void BandEnds::before_slab(std::int32_t slab) {
  for (; next_ < all_.size() && all_[next_].end.slab < slab; ++next_) {
    keep(all_[next_]);
    close(all_[next_]);
  }
  for (waiting_ = next_; next_ < all_.size() && all_[next_].end.slab == slab; ++next_) keep(all_[next_]);
}

/// Adds the part of the slab in front of the surfaces in it.
void BandEnds::behind_slab() {
  for (; waiting_ < next_; ++waiting_) {
    Ended& ended = all_[waiting_];
    const std::int64_t opacity = planes_ - 1;
    const float share = share_in_slab(ended.in_front[static_cast<std::size_t>(opacity)],
                                      ended.pixel[opacity * plane_stride_], ended.end.part);
    for (std::int64_t plane = 0; plane < planes_; ++plane) {
      float& in_front = ended.in_front[static_cast<std::size_t>(plane)];
      in_front += share * (ended.pixel[plane * plane_stride_] - in_front);
    }
    close(ended);
  }
}

void BandEnds::keep(Ended& ended) const {
  for (std::int64_t plane = 0; plane < planes_; ++plane)
    ended.in_front[static_cast<std::size_t>(plane)] = ended.pixel[plane * plane_stride_];
}

/// Makes the pixel opaque.
void BandEnds::close(const Ended& ended) const {
  ended.pixel[(planes_ - 1) * plane_stride_] = 1;
}

void BandEnds::restore() {
  for (const Ended& ended : std::span(all_).first(next_)) {
    for (std::int64_t plane = 0; plane < planes_; ++plane)
      ended.pixel[plane * plane_stride_] = ended.in_front[static_cast<std::size_t>(plane)];
  }
}

}  // namespace splatlas
