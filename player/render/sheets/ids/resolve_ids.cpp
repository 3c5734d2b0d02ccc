#include "player/render/sheets/ids/resolve_ids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "player/render/contributions/pixel_shares.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {
namespace {

/// The four sheet pixels around a sample.
struct IdNeighbours {
  std::int64_t x = 0, y = 0;  // the upper left one
  std::array<float, 4> weights{};

  IdNeighbours(const SheetWindow& window, double at_x, double at_y)
      : x(static_cast<std::int64_t>(std::floor(at_x))), y(static_cast<std::int64_t>(std::floor(at_y))) {
    weights = sheet_weights(static_cast<float>(at_x - std::floor(at_x)),
                            static_cast<float>(at_y - std::floor(at_y)), window.skew);
  }
  template <typename Visit>
  void for_each(const Visit& visit) const {
    visit(x, y, weights[0]), visit(x + 1, y, weights[1]);
    visit(x, y + 1, weights[2]), visit(x + 1, y + 1, weights[3]);
  }
};

/// Finds the structures of the pixels of a row.
class RowIds {
 public:
  RowIds(const SheetShares& shares, const Shear& shear, const FragmentsInVolume& fragments,
         const FragmentShares& of_fragments, const Picture& picture, IdImage& ids)
      : shares_(shares),
        shear_(shear),
        fragments_(fragments),
        of_fragments_(of_fragments),
        picture_(picture),
        ids_(ids),
        map_(picture_to_pixels(shear, shares.window)),
        samples_(samples_per_side(map_, shares.window)) {}

  /// Fills columns [begin, end).
  void fill(std::size_t row, std::size_t begin, std::size_t end_column) {
    const FragmentList& list = fragments_.list;
    const auto width = static_cast<std::size_t>(picture_.size.width);
    std::uint32_t next = list.first_of_row[row];
    const std::uint32_t end = list.first_of_row[row + 1];
    for (std::size_t column = begin; column < end_column; ++column) {
      const std::size_t pixel = row * width + column;
      const std::uint32_t first = next;
      while (next < end && list.samples[next].pixel == pixel) ++next;
      ids_.numbers[pixel] =
          picture_.rgba[4 * pixel + 3] < kMinIdOpacity
              ? StructureNumber{0}
              : number_at(pixel, static_cast<double>(column), static_cast<double>(row), first, next);
    }
  }

 private:
  StructureNumber number_at(std::size_t pixel, double column, double row, std::uint32_t first,
                            std::uint32_t last) {
    pixel_.clear();
    if (first < last) {
      const float share = 1 / static_cast<float>(last - first);
      for (std::uint32_t n = first; n < last; ++n) add_sample(n, column, row, share);
      return pixel_.largest();
    }
    const RayFaces faces = fragments_.faces != nullptr ? fragments_.faces->at(pixel) : RayFaces{};
    if (!faces.show()) {
      if (const StructureNumber only = only_winner(column, row); only != 0) return only;
    }
    between_.clear();
    for_each_sample(column, row,
                    [&](const IdNeighbours& neighbours) { add_volume(neighbours, 1, between_); });
    pixel_.add_between(faces, between_, 1);
    return pixel_.largest();
  }

  /// The structure that has the largest share of all sheet pixels around; 0 if they differ. All weights are
  /// positive, so it has the largest share of the pixel, too.
  [[nodiscard]] StructureNumber only_winner(double column, double row) const {
    StructureNumber one = 0;
    bool differ = false;
    for_each_sample(column, row, [&](const IdNeighbours& neighbours) {
      neighbours.for_each([&](std::int64_t x, std::int64_t y, float /*weight*/) {
        const StructureNumber winner = shares_.winner(x, y);
        if (winner == 0) return;
        differ = differ || (one != 0 && winner != one);
        one = winner;
      });
    });
    return differ ? StructureNumber{0} : one;
  }

  /// Calls visit(neighbours) for the samples of a pixel without fragments.
  template <typename Visit>
  void for_each_sample(double column, double row, const Visit& visit) const {
    for (int v = 0; v < samples_; ++v) {
      for (int u = 0; u < samples_; ++u)
        visit(neighbours_of(column + (u + 0.5) / samples_, row + (v + 0.5) / samples_));
    }
  }
  [[nodiscard]] IdNeighbours neighbours_of(double x, double y) const {
    return {shares_.window, map_.xx * x + map_.xy * y + map_.x0, map_.yx * x + map_.yy * y + map_.y0};
  }

  /// Adds the whole volume at a sample.
  void add_volume(const IdNeighbours& neighbours, float weight, PixelShares& sum) const {
    const float of_sample = weight / static_cast<float>(samples_ * samples_);
    add_point(neighbours, of_sample, sum);
  }
  void add_point(const IdNeighbours& neighbours, float weight, PixelShares& sum) const {
    neighbours.for_each([&](std::int64_t x, std::int64_t y, float of_pixel) {
      if (of_pixel == 0) return;
      shares_.for_each(
          x, y, [&](StructureNumber number, float share) { sum.add(number, weight * of_pixel * share); });
    });
  }

  /// Adds a sample with fragments: of each segment of the volume its shares, as in resolve().
  void add_sample(std::uint32_t n, double column, double row, float share) {
    const FragmentList& list = fragments_.list;
    const Sample& sample = list.samples[n];
    const double x = column + sample.place.right(), y = row + sample.place.down();
    std::optional<ClipDepths> kept;
    if (fragments_.cuts != nullptr)
      kept = fragments_.cuts->depths(x, y, shear_.scan.slice_axis, shear_.ascending ? 1.0 : -1.0);
    between_.clear();
    float transmittance = 1;  // of the surfaces so far
    for (std::uint32_t f = sample.first_fragment; f < list.samples[n + 1].first_fragment; ++f) {
      const Fragment& fragment = list.fragments[f];
      const float opacity = fragment.rgba[3], behind = transmittance * (1 - opacity);
      const float volume = fragments_.order.in_front_of(f, fragment.depth, kept ? &*kept : nullptr).rgba[3];
      between_.add(number_of(fragment.structure), transmittance * (1 - volume) * opacity);
      add_in_front(f, fragment.depth, kept ? &*kept : nullptr, transmittance - behind);
      transmittance = behind;
    }
    add_point(neighbours_of(x, y), transmittance, between_);
    const bool has_faces = fragments_.faces != nullptr && !list.faces.empty();
    pixel_.add_between(has_faces ? list.faces[n] : RayFaces{}, between_, share);
  }

  /// Adds the shares of the volume in front of a fragment.
  void add_in_front(std::uint32_t fragment, float depth, const ClipDepths* kept, float weight) {
    const std::uint32_t entry = fragments_.order.entry_of(fragment);
    if (entry == FragmentOrder::kNowhere) return;
    const float of_slab = fragments_.order.slab_share(fragment, depth, kept);
    for (const FragmentShare& share : of_fragments_.of_entry(entry)) {
      const float part = (share.before ? 1 - of_slab : 0) + (share.behind ? of_slab : 0);
      between_.add(share.number, weight * part * share.share);
    }
  }

  const SheetShares& shares_;
  const Shear& shear_;
  const FragmentsInVolume& fragments_;
  const FragmentShares& of_fragments_;
  const Picture& picture_;
  IdImage& ids_;
  Affine2 map_;
  int samples_;
  PixelShares pixel_, between_;
};

}  // namespace

void fill_rims(const Picture& picture, IdImage& ids) {
  const auto [width, height] = picture.size;
  const std::vector<StructureNumber> found = ids.numbers;
  for (int n = 0; n < width * height; ++n) {
    const auto opacity_of = [&](int pixel) { return picture.rgba[4 * static_cast<std::size_t>(pixel) + 3]; };
    if (found[static_cast<std::size_t>(n)] != 0 || opacity_of(n) < kMinIdOpacity) continue;
    float densest = 0;
    for (int y = std::max(n / width - 1, 0); y <= std::min(n / width + 1, height - 1); ++y) {
      for (int x = std::max(n % width - 1, 0); x <= std::min(n % width + 1, width - 1); ++x) {
        const int other = y * width + x;
        const StructureNumber number = found[static_cast<std::size_t>(other)];
        if (number == 0 || opacity_of(other) <= densest) continue;
        densest = opacity_of(other);
        ids.numbers[static_cast<std::size_t>(n)] = number;
      }
    }
  }
}

void resolve_ids(const SheetShares& shares, const Shear& shear, const FragmentsInVolume& fragments,
                 const FragmentShares& of_fragments, const PixelBox& region, const Picture& picture,
                 IdImage& ids, ThreadPool& pool) {
  constexpr std::size_t kBandRows = 16;
  const auto first = static_cast<std::size_t>(region.y_first),
             end = static_cast<std::size_t>(region.y_last) + 1;
  pool.for_each((end - first + kBandRows - 1) / kBandRows, [&](std::size_t band) {
    RowIds rows(shares, shear, fragments, of_fragments, picture, ids);
    for (std::size_t row = first + band * kBandRows; row < std::min(first + (band + 1) * kBandRows, end);
         ++row)
      rows.fill(row, static_cast<std::size_t>(region.x_first), static_cast<std::size_t>(region.x_last) + 1);
  });
}

}  // namespace splatlas
