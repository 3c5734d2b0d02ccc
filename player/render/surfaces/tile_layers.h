// Tiles of the rasteriser: the clusters of triangles that may meet each; layers of surfaces in front of its
// samples, composited front to back while it is rasterised; their edges, for adaptive supersampling.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/render/surfaces/fragments.h"
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

/// Clusters by tile: opaque ones, then those of each ghost, then others; near ones first. Keeps its memory
/// from frame to frame.
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

/// Summary of the surfaces at a pixel centre, without the volume.
struct SurfacesSeen {
  Radiance radiance;
  /// Signature of the visible layers: contributions of all surface sides, each weighted by its own four hash
  /// values. Pixels with the same layers in the same order have the same signature under any lighting.
  std::array<float, 4> layers{0, 0, 0, 0};
  float depth = 0;  ///< of the first fragment

  /// Adds the next fragment behind surfaces of this transmittance. `side` identifies surface and side.
  void add(std::uint32_t side, float transmittance, const Fragment& fragment);
  void add(const Face& face, float transmittance);
};

/// Thresholds of an edge between two neighbours. Their radiance must differ by more than kEdgeContrast in any
/// channel. Also, layers must differ by more than kEdgeLayers, or depths by more than kEdgeSlope pixels.
inline constexpr float kEdgeContrast = 1.0f / 32;
inline constexpr float kEdgeLayers = 1.0f / 16;
inline constexpr float kEdgeSlope = 4;

/// The summaries of a row of pixels. May write them to the vector, which keeps its size from row to row.
using SeenRow = std::function<const SurfacesSeen*(std::int32_t row, std::vector<SurfacesSeen>& room)>;

/// Sets `edges` to 1 for every pixel with an edge to one of its four neighbours, else to 0. Edges are visible
/// silhouettes, borders and intersections. `pixel_voxels` is that of RasterScene. `seen`: thread-safe.
void find_edge_pixels(const SeenRow& seen, const PictureSize& size, float pixel_voxels,
                      std::vector<std::uint8_t>& edges, ThreadPool& pool);

/// Intersection of a surface with the ray of a slot, a sample of a tile.
struct Crossing {
  double depth = 0;
  std::uint32_t slot = 0;
  std::uint32_t side = 0;             ///< twice the number of the surface, and 1 more on its front
  std::uint32_t triangle = 0;         ///< place in the clusters
  std::array<float, 3> normal_lps{};  ///< interpolated; of the visible side

  [[nodiscard]] std::uint32_t surface() const { return side >> 1; }
};

/// A depth in bins. Surfaces coincide if their depths lie in the same bin of 1/4096 voxel. The offset moves
/// bin limits away from common surface depths such as half voxels, where rounding would decide.
[[nodiscard]] inline double in_bins(double depth) {
  constexpr double kSteps = 4096, kOffset = 0.3183;
  return depth * kSteps + kOffset;
}
/// Number of the bin of a depth.
[[nodiscard]] inline double depth_bin(double depth) {
  return std::floor(in_bins(depth));
}
/// True for the crossing in front of the other one, in the same slot. Where surfaces coincide, back faces
/// precede front faces, and then structures decide.
[[nodiscard]] bool in_front(const Crossing& a, const Crossing& b, const RasterScene& scene);

/// A fragment of a slot.
struct SlotFragment {
  std::uint32_t slot = 0;
  Fragment fragment;
};

/// How a tile is drawn.
struct TileOptions {
  /// A slot ends once its transmittance is at most this, such as behind an opaque fragment.
  float termination_threshold = 0;
  bool keeps_fragments = false;  ///< and does not only composite them
  bool is_empty = false;         ///< no surface meets the tile
  /// Receives a summary of every pixel of the scene's region; empty: not asked for.
  std::span<SurfacesSeen> seen{};
};

/// Compositor of the slots of a tile. Crossings wait until everything in front of them is known. A slot ends
/// once its transmittance falls to the threshold. Keeps its memory between tiles. Not thread-safe.
class TileLayers {
 public:
  static constexpr std::uint32_t kStride = TileBins::kTileSide;  ///< of slots, from row to row

  /// Begins a tile of clear slots; for summaries, kStride apart in a row of pixels. `scene` must outlive it.
  void begin(const RasterScene& scene, const PixelBox& tile, std::size_t slots, const TileOptions& options);

  /// True for a tile of pixel centres whose faces are layers. Else they are composited with the pixels.
  [[nodiscard]] bool has_faces() const {
    return scene_->faces != nullptr && (options_.keeps_fragments || !options_.seen.empty());
  }
  /// A face of a cut in front of a slot, or behind everything in it.
  void pass_face(std::uint32_t slot, const Face& face);
  /// Adds a crossing, for the caller to fill in.
  Crossing& add() { return waiting_.emplace_back(); }
  /// True if so many crossings wait that it is time to composite.
  [[nodiscard]] bool is_due() const { return waiting_.size() >= due_; }
  /// Composites crossings that none at `depth` or behind it can precede. Returns the slots that end there.
  std::span<const std::uint32_t> pass(float depth);

  /// True if the tile had any crossing.
  [[nodiscard]] bool any() const { return any_ || !waiting_.empty(); }
  [[nodiscard]] bool is_clear(std::uint32_t slot) const {
    return transmittances_[slot] > options_.termination_threshold;
  }
  [[nodiscard]] const Radiance& radiance(std::uint32_t slot) const { return radiances_[slot]; }
  /// Number of crossings that wait, and of fragments.
  [[nodiscard]] std::size_t held() const { return waiting_.size() + fragments_.size(); }
  /// Fragments so far, front to back within each slot.
  [[nodiscard]] std::span<const SlotFragment> fragments() const { return fragments_; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  void sort_slots(std::uint32_t count);
  void sort_chain(std::uint32_t first);
  void composite(std::span<const std::uint32_t> crossings);
  [[nodiscard]] SurfacesSeen& seen(std::uint32_t slot) const {
    return options_.seen[scene_->region.place(tile_.x_first, tile_.y_first) +
                         slot / kStride * static_cast<std::size_t>(scene_->region.width()) + slot % kStride];
  }

  const RasterScene* scene_ = nullptr;
  PixelBox tile_;
  TileOptions options_;
  bool any_ = false;
  std::vector<Radiance> radiances_;      // of the slots
  std::vector<float> transmittances_;    // the same
  std::vector<std::uint32_t> first_;     // of waiting_, the same; kNone but in sort_slots()
  std::size_t due_ = 0;                  // crossings
  std::vector<Crossing> waiting_;        // those to composite come first in pass()
  std::vector<std::uint32_t> next_;      // of waiting_, in the same slot
  std::vector<std::uint32_t> chain_;     // of one slot
  std::vector<std::uint32_t> sequence_;  // of waiting_, front to back within each slot
  std::vector<std::uint32_t> ended_;
  std::vector<SlotFragment> fragments_;
};

}  // namespace splatlas
