// A-buffer rasteriser of a tile (Carpenter 1984), with a depth buffer for opaque surfaces.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "player/render/surfaces/edge_pixels.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/surfaces/raster_scene.h"
#include "player/render/surfaces/screen_triangle.h"
#include "player/render/surfaces/tile_bins.h"

namespace splatlas {

/// The visible fragments of a tile by slot, front to back.
struct TileFragments {
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> end_of_slot;

  [[nodiscard]] std::span<const Fragment> of_slot(std::size_t slot) const {
    const std::size_t begin = slot == 0 ? 0 : end_of_slot[slot - 1];
    return std::span(fragments).subspan(begin, end_of_slot[slot] - begin);
  }
};

/// Pixels of a picture of surfaces.
struct PaintedPicture {
  std::span<float> rgba;
  std::span<float> depths;  ///< of opaque surfaces; empty: not asked for
};

/// Rasteriser of one tile after another; keeps its memory between tiles. A slot is a sample position with the
/// nearest opaque crossing and a list of translucent ones. Not thread-safe.
class TileRasterizer {
 public:
  /// Slot of a pixel centre in a tile: kStride per row, also in tiles at the border of the picture.
  static constexpr std::uint32_t kStride = TileBins::kTileSide;

  /// Begins a tile with one slot per pixel, at its centre.
  void begin(const RasterScene& scene, const PixelBox& tile);
  /// Begins a tile with one slot per point of `pattern` in every pixel whose `wanted` flag is not 0, row by
  /// row. `wanted` has a flag for every pixel of the picture. `pattern` must outlive the tile.
  void begin_edges(const RasterScene& scene, const PixelBox& tile, std::span<const std::uint8_t> wanted,
                   std::span<const SubPixel> pattern);
  /// Rasterises a cluster of the tile. Opaque surfaces must come first, and near ones should.
  void draw(const TileCluster& of);
  /// Sorts fragments by slot and depth. A slot ends once its transmittance is at most
  /// `termination_threshold`, such as behind an opaque fragment. `seen` of the picture receives a summary of
  /// every pixel unless it is empty; the faces of the scene are in front of and behind all fragments.
  void finish(float termination_threshold, TileFragments& out, std::span<SurfacesSeen> seen);
  /// Composites the fragments instead, and writes the mean of the slots of each pixel into the picture.
  void paint(float termination_threshold, const PaintedPicture& picture, std::span<SurfacesSeen> seen);

  /// Number of translucent crossings so far.
  [[nodiscard]] std::size_t crossings() const { return crossings_.size(); }
  [[nodiscard]] std::size_t slots() const { return hiding_.size(); }

 private:
  static constexpr std::uint32_t kBlocks = TileBins::kTileSide / TileBins::kBlockSide;  // along each axis
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr float kNothingHidden = std::numeric_limits<float>::infinity();

  /// Intersection of a surface with the ray of a slot.
  struct Crossing {
    std::uint64_t order = 0;  ///< sort key: depth bin, then back faces before front faces
    std::uint32_t slot = 0;
    float depth = 0;
    std::uint32_t surface = 0, triangle = 0;
    std::array<float, 2> weights{};  ///< of the second and third corner
  };
  /// A vertex of the current cluster.
  struct Vertex {
    ScreenVertex snapped;
    ScreenPoint point;
    float depth = 0;
    std::uint8_t removing = 0;  ///< planes of the cut that remove it
  };
  /// The triangle, or a part of it, that is being rasterised.
  struct Current {
    std::uint32_t surface = 0, triangle = 0;
    bool is_opaque = false;
    bool hides_back = false;  ///< clockwise triangles are behind counter-clockwise ones
    SurfaceClusters::Front front{};
    std::array<ScreenPoint, 3> points;
    std::array<double, 3> depths{};
    float nearest = 0;
    const ClippedTriangle* part = nullptr;
    const CutRays* cuts = nullptr;  ///< null if it is kept whole
    std::optional<TriangleAttributes> attributes;
  };

  void clear(std::size_t slots);
  [[nodiscard]] bool is_hidden(const TileCluster& of) const;
  void place_vertices(const SurfaceClusters::Cluster& cluster, bool is_cut);
  void draw_parts(Current& current);
  void draw_triangle(const std::array<ScreenVertex, 3>& corners, Current& current);
  [[nodiscard]] bool is_hidden(const PixelBox& box, float nearest) const;
  void sample_centers(const ScreenTriangle& t, const PixelBox& box, Current& current);
  void sample_patterns(const ScreenTriangle& t, const PixelBox& box, Current& current);
  /// A sample inside a triangle; `x`, `y` with integer pixel centres.
  void hit(const ScreenTriangle& t, const EdgeWalk::Edges& edges, double x, double y, std::uint32_t slot,
           Current& current);
  /// Depths by pixel, kStride per row, behind which nothing is seen; pixels without slots see nothing.
  void hide_behind_faces(std::uint32_t columns, std::uint32_t rows);
  /// True if an opaque surface is seen.
  [[nodiscard]] bool has_nearest(std::size_t slot) const { return std::abs(hiding_[slot]) < kNothingHidden; }
  [[nodiscard]] const float* hiding_of_pixels() const {
    return pixel_hiding_.empty() ? hiding_.data() : pixel_hiding_.data();
  }
  void renew_pixel(std::uint32_t pixel);
  void renew_block(std::uint32_t block);
  [[nodiscard]] bool in_front(const Crossing& a, const Crossing& b) const;
  /// Interpolated normal of the visible side, in LPS.
  [[nodiscard]] std::array<float, 3> normal_of(const Crossing& crossing) const;
  /// Identifies a surface and its side.
  static std::uint32_t side_of(const Crossing& crossing) {
    return (crossing.surface << 1) | static_cast<std::uint32_t>(crossing.order & 1);
  }
  void sort_by_slot();
  void sort_slot(std::span<std::uint32_t> of_slot) const;
  [[nodiscard]] Fragment fragment(const Crossing& crossing) const;
  /// Composites the fragments of a slot, front to back. Adds them to `out` and to `seen`, unless null.
  Radiance finish_slot(std::uint32_t slot, const RayFaces& faces, float termination_threshold,
                       std::vector<Fragment>* out, SurfacesSeen* seen);
  /// paint() of a row of pixel centres without translucent crossings.
  void paint_opaque_row(std::int32_t y, const PaintedPicture& picture, std::span<SurfacesSeen> seen) const;
  /// Calls visit(pixel of the picture, first slot) for the pixels of the tile that have slots, row by row.
  template <typename Visit>
  void for_each_pixel(const Visit& visit) const;

  const RasterScene* scene_ = nullptr;
  PixelBox tile_;
  std::span<const SubPixel> pattern_;
  std::vector<std::uint32_t> slot_of_pixel_;  // first slot; empty if every pixel has one slot
  std::vector<Crossing> nearest_;             // opaque, by slot, where hiding_ is finite
  std::vector<float> hiding_;        // depth behind which it hides everything, by slot; infinite: none
  std::vector<float> pixel_hiding_;  // furthest of the slots of each pixel; empty if that is hiding_
  std::array<float, std::size_t{kBlocks} * kBlocks> block_hiding_{};  // furthest of the pixels of each block
  bool changed_ = false;                                              // by the current cluster
  std::vector<Vertex> vertices_;                                      // of the current cluster
  std::vector<ClippedTriangle> parts_;
  std::vector<Crossing> crossings_;         // translucent
  std::vector<Crossing> sorted_;            // by slot
  std::vector<std::uint32_t> end_of_slot_;  // in sorted_; empty without translucent ones
  std::vector<std::uint32_t> order_;        // of sorted_, by depth within a slot
  std::vector<std::uint32_t> hulls_;        // of the ghosts that the current slot has passed
};

}  // namespace splatlas
