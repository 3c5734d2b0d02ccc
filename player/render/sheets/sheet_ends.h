// Ends of the rays of a sheet at opaque surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/slabs.h"
#include "player/render/view/shear.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

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
