// Bands of a sheet: their accumulation buffers; surface fragments, composited with the volume between them
// while its slabs are splatted; ends of rays at opaque surfaces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/sheets/slabs.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Radiance and opacity of fine rows [first, last) of a window. Layout: [fine row][phase][plane][stride()],
/// with planes of emissions (red, green, blue, or white alone), then opacity. One pixel before and one after
/// each row are readable.
class BandImage {
 public:
  /// A transparent image in the memory of `floats`, which must outlive it.
  BandImage(const SheetWindow& window, int emissions, std::int64_t first, std::int64_t last,
            std::vector<float>& floats)
      : scale_(window.scale),
        columns_(window.columns),
        planes_(1 + emissions),
        stride_(stride(window)),
        first_(first),
        last_(last),
        floats_(floats) {
    floats_.assign(static_cast<std::size_t>((last_ - first_) * row_stride()), 0.0f);
    opaque_.resize(static_cast<std::size_t>((last_ - first_) * scale_));
  }

  /// Floats of a plane of a row, with margins, rounded up to whole blocks.
  static std::int64_t stride(const SheetWindow& window) {
    return (window.columns + 2 * ImageRows::kMargin + kBlock - 1) / kBlock * kBlock;
  }

  /// Place of pixel 0 of the first plane in the floats of the image. `fine_row`: from the first one.
  static std::int64_t begin_of(std::int64_t fine_row, std::int64_t phase, const SheetWindow& window,
                               std::int64_t planes) {
    return (fine_row * window.scale + phase) * planes * stride(window) + ImageRows::kMargin;
  }
  [[nodiscard]] const float* begin() const { return floats_.data(); }

  [[nodiscard]] std::int64_t first_fine_row() const { return first_; }
  [[nodiscard]] std::int64_t last_fine_row() const { return last_; }
  [[nodiscard]] std::int64_t planes() const { return planes_; }
  [[nodiscard]] std::int64_t plane_stride() const { return stride_; }
  [[nodiscard]] std::int64_t row_stride() const { return scale_ * phase_stride(); }

  /// Pixel 0 of the first plane.
  [[nodiscard]] float* row(std::int64_t fine_row, std::int64_t phase) const {
    return floats_.data() + (fine_row - first_) * row_stride() + phase * phase_stride() + ImageRows::kMargin;
  }
  [[nodiscard]] const OpaquePixels& opaque(std::int64_t fine_row, std::int64_t phase) const {
    return opaque_[static_cast<std::size_t>((fine_row - first_) * scale_ + phase)];
  }
  /// Kernel access from a fine row and a phase on. Pairs of voxel rows are `scale` fine rows apart.
  [[nodiscard]] ImageRows rows(std::int64_t fine_row, std::int64_t phase) {
    return {row(fine_row, phase),
            columns_,
            stride_,
            phase_stride(),
            row_stride(),
            row_stride() * scale_,
            opaque_.data() + (fine_row - first_) * scale_ + phase,
            scale_,
            scale_ * scale_};
  }

 private:
  [[nodiscard]] std::int64_t phase_stride() const { return planes_ * stride_; }

  std::int64_t scale_, columns_, planes_, stride_, first_, last_;
  std::vector<float>& floats_;
  std::vector<OpaquePixels> opaque_;  // row major: [fine row][phase]
};

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

/// The sheet pixels whose rays end at an opaque surface, by row.
class SheetEnds {
 public:
  struct End {
    std::int32_t slab = 0;               ///< that contains the surface
    std::int32_t column = 0, phase = 0;  ///< of the sheet pixel
    float part = 0;                      ///< of the slab, in front of the surface
  };

  /// Finds the surface of each pixel of the sheet: that of the nearest picture pixel. `depths`: of opaque
  /// surfaces by picture pixel, as of fragments; infinite: none. Keeps its memory from frame to frame. Cost:
  /// linear in sheet pixels.
  void build(std::span<const float> depths, const PictureSize& size, const Shear& shear,
             const SheetWindow& window, const Slabs& slabs, ThreadPool& pool);

  /// Ends of a fine row.
  [[nodiscard]] std::span<const End> of_row(std::int64_t fine_row) const {
    return rows_[static_cast<std::size_t>(fine_row)];
  }

 private:
  std::vector<std::vector<End>> rows_;
};

/// The ends in a band of rows. Keeps the radiance in front of each surface, and makes the pixel opaque, so
/// that nothing behind the surface is splatted. Used by Band as BandFragments.
class BandEnds {
 public:
  BandEnds(const SheetEnds& ends, BandImage& image);

  void before_slab(std::int32_t slab);
  void behind_slab();
  void finish() {}

  /// Puts the radiance in front of the surfaces into the image. After the last slab.
  void restore();

 private:
  struct Ended {
    SheetEnds::End end;
    float* pixel = nullptr;           ///< of the first plane
    std::array<float, 4> in_front{};  ///< radiance by plane
  };

  void keep(Ended& ended) const;
  void close(const Ended& ended) const;

  std::int64_t planes_, plane_stride_;
  std::vector<Ended> all_;              // by slab
  std::size_t waiting_ = 0, next_ = 0;  // those before are passed; those between are in the current slab
};

}  // namespace splatlas
