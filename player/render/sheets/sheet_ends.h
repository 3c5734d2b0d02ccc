// Ends of the rays of a sheet at opaque surfaces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/fragment_order.h"
#include "player/render/view/shear.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// The sheet pixels whose rays end at an opaque surface, by row and slab.
class SheetEnds {
 public:
  struct End {
    std::int32_t slab = 0;               ///< that contains the surface
    std::int32_t column = 0, phase = 0;  ///< of the sheet pixel
    float part = 0;                      ///< of the slab, in front of the surface
  };

  /// Finds the surface of each pixel of the sheet: that of the nearest picture pixel. `depths`: of opaque
  /// surfaces by picture pixel, as of fragments; infinite: none. `order`: built for the window. Keeps its
  /// memory from frame to frame. Cost: linear in sheet pixels.
  void build(std::span<const float> depths, const PictureSize& size, const Shear& shear,
             const SheetWindow& window, const FragmentOrder& order, ThreadPool& pool);

  /// Ends of a fine row, front to back by slab.
  [[nodiscard]] std::span<const End> of_row(std::int64_t fine_row) const {
    return rows_[static_cast<std::size_t>(fine_row)];
  }

 private:
  std::vector<std::vector<End>> rows_;
};

/// The ends in a band of rows. Keeps the radiance in front of each surface, and makes the pixel opaque, so
/// that nothing behind the surface is splatted. Used by Band in the place of SheetFragments.
class BandEnds {
 public:
  BandEnds(const SheetEnds& ends, BandImage& image);

  [[nodiscard]] bool empty() const { return all_.empty(); }
  /// As of SheetFragments.
  void before_slab(std::int64_t fine_row, std::int32_t slab, const AccumulatedRow& /*row*/) {
    if (Row& of = rows_[static_cast<std::size_t>(fine_row - first_)]; of.next_slab <= slab) reach(of, slab);
  }
  void behind_slab(std::int64_t fine_row, const AccumulatedRow& /*row*/) {
    if (Row& of = rows_[static_cast<std::size_t>(fine_row - first_)]; of.waiting < of.next) pass(of);
  }
  void finish(std::int64_t /*fine_row*/, const AccumulatedRow& /*row*/) {}

  /// Puts the radiance in front of the surfaces into the image. After the last slab.
  void restore();

 private:
  struct Ended {
    SheetEnds::End end;
    float* pixel = nullptr;           ///< of the first plane
    std::array<float, 4> in_front{};  ///< radiance by plane
  };
  /// Ends [waiting, next) are in the current slab, those before are passed.
  struct Row {
    std::int32_t next_slab = 0;
    std::size_t begin = 0, waiting = 0, next = 0, end = 0;
  };

  void set_next(Row& row, std::size_t next) const;
  void reach(Row& row, std::int32_t slab);
  void pass(Row& row);
  void close(Ended& ended) const;

  std::int64_t first_, planes_, plane_stride_;
  std::vector<Row> rows_;
  std::vector<Ended> all_;  // by row and slab
};

}  // namespace splatlas
