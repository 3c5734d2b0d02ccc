// Surface fragments in a sheet: composited with the volume between them while its slabs are splatted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/slabs.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// The fragments of a picture by band of the sheet, front to back within each sample.
class SheetFragments {
 public:
  struct Entry {
    std::uint32_t fragment = 0, sample = 0;
    std::int32_t slab = 0;  ///< that contains the fragment, or the one before it in the sample
    float part = 0;         ///< of the slab in front of the fragment, without a cut
  };

  /// Bands of `band_rows` fine rows; their images have `planes` planes. `cuts`: clip the volume; null: none.
  /// `fragments` and `cuts` must outlive the use. Fragments beside the sheet are composited at once. Keeps
  /// its memory from frame to frame. Linear in fragments.
  void build(const FragmentList& fragments, const CutRays* cuts, const PictureSize& size, const Shear& shear,
             const SheetWindow& window, const Slabs& slabs, int planes, std::int64_t band_rows,
             ThreadPool& pool);

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// As of the list.
  [[nodiscard]] std::span<const SheetSample> samples() const { return samples_; }

 private:
  friend class BandFragments;

  /// The part of a fragment's slab in front of it, in the kept part of its ray.
  [[nodiscard]] float kept_part(const Entry& of, const Slabs& slabs) const;

  const FragmentList* list_ = nullptr;
  const CutRays* cuts_ = nullptr;
  int width_ = 1;  // of the picture
  std::size_t slice_axis_ = 2;
  double depth_sign_ = 1;
  std::vector<SheetSample> samples_;        // as of the list
  std::vector<Entry> entries_;              // by band
  std::vector<std::size_t> first_of_band_;  // one more than bands
};

/// The fragments of one band, slab by slab. Keeps its memory from band to band. Not thread-safe.
class BandFragments {
 public:
  /// `image`: of the band, with the first row of the next one. `color`: of a volume of one colour.
  void begin(SheetFragments& fragments, std::size_t band, const Slabs& slabs, const BandImage& image,
             const std::array<float, 3>& color);

  /// To call before and after a slab is composited; slabs come front to back.
  void before_slab(std::int32_t slab);
  void behind_slab();
  /// After the last slab.
  void finish() { before_slab(static_cast<std::int32_t>(slabs_->count())); }

 private:
  /// Radiance of the slabs splatted so far, at a sample.
  [[nodiscard]] Radiance radiance_at(const SheetSample& sample) const;
  [[nodiscard]] float plane_at(const SheetSample& sample, std::int64_t plane) const {
    const float* const upper = pixels_ + plane * plane_stride_;
    const float* const lower = upper + row_stride_;
    const auto& [a, b, c, d] = sample.weights;
    return (a * upper[sample.left] + b * upper[sample.right]) +
           (c * lower[sample.left] + d * lower[sample.right]);
  }

  SheetFragments* all_ = nullptr;
  const Slabs* slabs_ = nullptr;
  const float* pixels_ = nullptr;  // of the band
  std::int64_t planes_ = 4, plane_stride_ = 0, row_stride_ = 0;
  std::array<float, 3> color_{};
  std::vector<SheetFragments::Entry> entries_;  // by slab
  std::vector<std::size_t> next_of_slab_;       // while they are sorted
  std::size_t next_ = 0;                        // entry
  std::vector<Radiance> in_front_;              // of the slab, of the next entries
};

}  // namespace splatlas
