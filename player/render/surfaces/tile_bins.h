// Bins of the rasteriser: the clusters of triangles that may meet each tile of a picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/render/surfaces/raster_scene.h"
#include "player/render/surfaces/screen_triangle.h"

namespace splatlas {

/// A cluster in a tile.
struct TileCluster {
  float nearest = 0;  ///< depth of the nearest corner of its box
  std::uint32_t surface = 0, cluster = 0;
  bool is_cut = false;  ///< a plane of the cut may remove a part of it
  /// Blocks of the tile that its box meets, both ends included.
  std::uint8_t x_first = 0, x_last = 0, y_first = 0, y_last = 0;
};

/// Clusters by tile, opaque ones first, near ones first. Keeps its memory from frame to frame.
class TileBins {
 public:
  static constexpr int kTileSide = 64;  ///< in pixels: depths of a tile fit the L1 cache
  static constexpr int kBlockSide = 8;  ///< in pixels; a tile has 8 x 8 blocks

  /// Projects the box of every cluster. Omits clusters out of view, behind the eye, or removed by one plane
  /// of the cut. The result is independent of the number of threads.
  void fill(const RasterScene& scene, ThreadPool& pool);

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t tiles() const { return rows_ * columns_; }
  /// Pixels of a tile, within the region of the scene.
  [[nodiscard]] PixelBox box(std::size_t tile) const;
  [[nodiscard]] std::span<const TileCluster> of_tile(std::size_t tile) const {
    return std::span(clusters_).subspan(first_of_tile_[tile],
                                        first_of_tile_[tile + 1] - first_of_tile_[tile]);
  }

 private:
  struct Placed {
    std::uint32_t tile = 0;
    TileCluster cluster;
  };
  void place(const RasterScene& scene, std::uint32_t surface, std::uint32_t cluster,
             std::vector<Placed>& out) const;

  PixelBox region_;
  std::size_t rows_ = 0, columns_ = 0;
  std::vector<std::vector<Placed>> of_job_;
  std::vector<std::size_t> first_of_tile_;
  std::vector<TileCluster> clusters_;
};

}  // namespace splatlas
