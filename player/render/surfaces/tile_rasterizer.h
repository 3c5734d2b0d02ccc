// A-buffer rasteriser of a tile (Carpenter 1984), with depth buffers for opaque surfaces and ghosts.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "player/render/surfaces/raster_scene.h"
#include "player/render/surfaces/screen_triangle.h"
#include "player/render/surfaces/tile_layers.h"

namespace splatlas {

/// The visible fragments of a tile by slot, front to back.
struct TileFragments {
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> end_of_slot;

  [[nodiscard]] std::span<const Fragment> of_slot(std::size_t slot) const {
    if (fragments.empty()) return {};
    const std::size_t begin = slot == 0 ? 0 : end_of_slot[slot - 1];
    return std::span(fragments).subspan(begin, end_of_slot[slot] - begin);
  }
};

/// The vertices of the current cluster, and its triangles in a box. Keeps its memory between clusters.
class ScreenCluster {
 public:
  /// Projects the vertices. `cuts`: planes that may remove some; null: none.
  void place(const SurfaceClusters::Cluster& cluster, const RasterScene& scene, const CutRays* cuts);
  /// The numbers of the triangles whose pixels_of() with this reach meet a box; all if a vertex is outside.
  [[nodiscard]] std::span<const std::uint32_t> triangles_in(const PixelBox& box, std::int32_t reach);

  [[nodiscard]] ScreenVertex snapped(std::size_t vertex) const {
    return {snapped_x_[vertex], snapped_y_[vertex]};
  }
  [[nodiscard]] ScreenPoint point(std::size_t vertex) const { return points_[vertex]; }
  [[nodiscard]] float depth(std::size_t vertex) const { return depths_[vertex]; }
  /// Planes of the cut that remove a vertex, as bits.
  [[nodiscard]] std::uint8_t removing(std::size_t vertex) const { return removing_[vertex]; }

 private:
  static constexpr std::size_t kVertices = 3 * SurfaceClusters::kMaxTriangles;

  bool is_on_ = false;  // the screen, with all vertices
  std::span<const SurfaceClusters::Triangle> triangles_;
  std::array<ScreenPoint, kVertices> points_{};
  std::array<std::int32_t, kVertices + kRasterPadding> snapped_x_{}, snapped_y_{};
  std::array<float, kVertices> depths_{};
  std::array<std::uint8_t, kVertices> removing_{};
  std::array<std::uint32_t, SurfaceClusters::kMaxTriangles + kRasterPadding> corners_{}, chosen_{};
};

/// Rasteriser of one tile after another; keeps its memory between tiles. A slot is a sample position with the
/// nearest opaque crossing, and the layers of translucent surfaces in front of it. Not thread-safe.
class TileRasterizer {
 public:
  /// Slot of a pixel centre in a tile: kStride per row, also in tiles at the border of the picture.
  static constexpr std::uint32_t kStride = TileLayers::kStride;

  /// Begins a tile with one slot per pixel, at its centre. Faces of the scene dim the fragments that are
  /// kept, or are painted with them.
  void begin(const RasterScene& scene, const PixelBox& tile, const TileOptions& options);
  /// Begins a tile with one slot per point of `pattern` in every pixel whose `wanted` flag is not 0, row by
  /// row. `wanted` has a flag for every pixel of the scene's region. `pattern` must outlive the tile.
  /// `options`: without summaries. Faces are painted.
  void begin_edges(const RasterScene& scene, const PixelBox& tile, std::span<const std::uint8_t> wanted,
                   std::span<const SubPixel> pattern, const TileOptions& options);
  /// Rasterises the next cluster of the tile, in the order of TileBins::of_tile().
  void draw(const TileCluster& of);
  /// Ends the tile: sorts its fragments by slot and depth.
  void finish(TileFragments& out);
  /// Ends the tile: writes the mean of the slots of a pixel to the picture. `depths`: as Rasterizer::paint().
  void paint(std::vector<float>& rgba, std::vector<float>* depths);

  /// Number of crossings and fragments that it holds.
  [[nodiscard]] std::size_t held() const { return layers_.held(); }

 private:
  static constexpr std::uint32_t kBlocks = TileBins::kTileSide / TileBins::kBlockSide;  // along each axis
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr float kNothingHidden = std::numeric_limits<float>::infinity();

  /// The triangle, or a part of it, that is being rasterised.
  struct Current {
    std::uint32_t surface = 0, triangle = 0;
    bool hides = false;       ///< what lies behind it; its surface is opaque or a ghost
    bool hides_back = false;  ///< clockwise triangles are behind counter-clockwise ones
    SurfaceClusters::Front front{};
    std::array<ScreenPoint, 3> points;
    std::array<double, 3> depths{};
    float nearest = 0;
    const ClippedTriangle* part = nullptr;
    const CutRays* cuts = nullptr;  ///< null if it is kept whole
    std::optional<TriangleAttributes> attributes;
    std::uint32_t side = 0;                         ///< Crossing::side, with the attributes
    std::array<std::array<float, 3>, 3> normals{};  ///< of the corners, on the visible side; the same
  };

  /// The nearest crossings that hide what is behind them.
  struct DepthBuffer {
    std::vector<Crossing> nearest;  // by slot, where it has one
    std::vector<float> of_slot;     // depth behind which it hides everything; infinite: none
    std::vector<float> of_pixel;    // furthest of its slots; empty if every pixel has one slot
    std::array<float, std::size_t{kBlocks} * kBlocks> of_block{};  // furthest of its pixels

    [[nodiscard]] bool has(std::size_t slot) const { return std::abs(of_slot[slot]) < kNothingHidden; }
  };

  void clear(std::size_t slots, const TileOptions& options);
  void pass_sample_faces();
  [[nodiscard]] bool is_hidden(const TileCluster& of) const;
  void draw(const SurfaceClusters::Triangle& triangle, Current& current);
  void draw_parts(Current& current);
  void draw_triangle(const std::array<ScreenVertex, 3>& corners, Current& current);
  [[nodiscard]] bool is_hidden(const PixelBox& box, float nearest) const;
  void sample_centers(const ScreenTriangle& t, const PixelBox& box, Current& current);
  void sample_small(const ScreenTriangle& t, const PixelBox& box, Current& current);
  void sample_patterns(const ScreenTriangle& t, const PixelBox& box, Current& current);
  void set_up_side(Current& current) const;
  /// A sample inside a triangle; `x`, `y` with integer pixel centres.
  void hit(const ScreenTriangle& t, const EdgeWalk::Edges& edges, double x, double y, std::uint32_t slot,
           Current& current);
  /// Ends the current hull, whose nearest crossings become layers, and begins that of a ghost, if any.
  void change_hull(std::optional<std::uint32_t> ghost);
  [[nodiscard]] const float* hiding_of_pixels() const {
    return depth_.of_pixel.empty() ? depth_.of_slot.data() : depth_.of_pixel.data();
  }
  void renew_pixel(std::uint32_t pixel);
  void renew_block(std::uint32_t block);
  /// Composites the layers that no crossing at `depth` or behind it can precede.
  void pass_layers(float depth);
  /// Composites all layers, opaque surfaces and the faces behind them included.
  void pass_all_layers();
  /// paint() of the layers, and of a row of pixel centres without translucent crossings.
  void paint_layers(std::vector<float>& rgba);
  void paint_opaque_row(std::int32_t y, std::vector<float>& rgba, std::vector<float>* depths) const;
  /// Calls visit(pixel of the picture, first slot) for the pixels of the tile that have slots, row by row.
  template <typename Visit>
  void for_each_pixel(const Visit& visit) const;

  const RasterScene* scene_ = nullptr;
  PixelBox tile_;
  std::span<const SubPixel> pattern_;
  std::vector<std::uint32_t> slot_of_pixel_;  // first slot; empty if every pixel has one slot
  DepthBuffer depth_;                         // of opaque surfaces, or of them and the hull
  DepthBuffer other_;                         // of opaque surfaces while a hull is drawn
  std::optional<std::uint32_t> hull_;         // its ghost
  bool changed_ = false;                      // depth_, by the current cluster
  ScreenCluster cluster_;
  std::vector<ClippedTriangle> parts_;
  std::vector<std::uint32_t> pixel_of_slot_;  // by slot over the size of the pattern
  std::vector<RayFaces> faces_;               // of the samples of edges, by slot; empty without faces
  std::span<SurfacesSeen> seen_;
  TileLayers layers_;
};

template <typename Visit>
void TileRasterizer::for_each_pixel(const Visit& visit) const {
  for (std::int32_t y = tile_.y_first; y <= tile_.y_last; ++y) {
    const std::size_t row = scene_->size.pixel(0, y);
    auto in_tile = static_cast<std::uint32_t>(y - tile_.y_first) * kStride;
    for (std::int32_t x = tile_.x_first; x <= tile_.x_last; ++x, ++in_tile) {
      const std::uint32_t slot = slot_of_pixel_.empty() ? in_tile : slot_of_pixel_[in_tile];
      if (slot != kNone) visit(row + static_cast<std::size_t>(x), slot);
    }
  }
}

}  // namespace splatlas
