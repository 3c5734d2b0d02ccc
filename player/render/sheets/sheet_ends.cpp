#include "player/render/sheets/sheet_ends.h"

#include <algorithm>
#include <cmath>

namespace splatlas {

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
        const float depth = depths[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                                   static_cast<std::size_t>(x)];
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
