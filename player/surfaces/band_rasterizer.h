// The triangles of a band of picture rows, to sorted fragments.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "player/surfaces/edge_pixels.h"
#include "player/surfaces/fragments.h"
#include "player/surfaces/raster_scene.h"
#include "player/surfaces/screen_triangle.h"
#include "player/surfaces/triangle_attributes.h"
#include "player/surfaces/triangle_bins.h"

namespace splatlas {

/// What is left of a band: the fragments of its slots, front to back.
struct BandFragments {
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> end_of_slot;

  [[nodiscard]] std::size_t begin_of(std::size_t slot) const { return slot == 0 ? 0 : end_of_slot[slot - 1]; }
  [[nodiscard]] std::span<const Fragment> of_slot(std::size_t slot) const {
    return std::span(fragments).subspan(begin_of(slot), end_of_slot[slot] - begin_of(slot));
  }
};

/// Samples the pixels of some rows of the picture; one band after another, to keep its memory.
class BandRasterizer {
 public:
  /// Every pixel of rows [first_row, last_row) has one slot, its centre.
  void begin(const RasterScene& scene, const TriangleBins& bins, int first_row, int last_row);
  /// Pixels that are wanted (not 0; width * rows of them) have a slot for every point of `pattern`, others
  /// have none. `pattern` must outlive the band.
  void begin_edges(const RasterScene& scene, const TriangleBins& bins, int first_row, int last_row,
                   std::span<const std::uint8_t> wanted, std::span<const SubPixel> pattern);
  /// Opaque surfaces come first: what they hide is never shaded.
  void draw(const TriangleRef& ref);
  /// Sorts by slot and depth; leaves out what is behind an opaque fragment, and behind surfaces that let
  /// through no more than `transmittance_floor` together. `seen` (of every slot) may be empty.
  void finish(float termination_threshold, BandFragments& out, std::span<SurfacesSeen> seen);

  /// Translucent crossings so far, and opaque ones that nothing hides once all is drawn.
  [[nodiscard]] std::size_t crossings() const { return crossings_.size(); }
  [[nodiscard]] std::size_t slots() const { return end_of_slot_.size(); }

 private:
  /// A surface where it crosses the ray of a slot.
  struct Crossing {
    std::uint64_t order = 0;  ///< by depth; of those that coincide, first the ones that are left
    std::uint32_t slot = 0;
    float depth = 0;
    std::uint32_t surface = kNone;
    std::uint32_t triangle = 0;
    /// Translucent: diffuse and highlight. Opaque: the weights of the triangle's second and third corner; it
    /// is shaded when nothing can hide it any more.
    std::array<float, 2> light{};
  };
  static constexpr std::uint32_t kNone = 0xffffffff;

  void clear(std::size_t slots);
  void sample_centers(const ScreenTriangle& t);
  void sample_patterns(const ScreenTriangle& t);
  [[nodiscard]] bool is_hidden(const ScreenTriangle& t, std::uint32_t slot) const;
  [[nodiscard]] PixelBox clipped(PixelBox box) const;
  [[nodiscard]] bool in_front(const Crossing& a, const Crossing& b) const;
  void add(const ScreenTriangle& triangle, const TriangleAttributes& attributes, std::uint32_t slot,
           std::array<float, 3> weight, double depth);
  [[nodiscard]] SurfaceShading lit(const SurfaceMesh& mesh, std::uint32_t triangle, bool front,
                                   const std::array<float, 3>& weight) const;
  void take_opaque();
  void sort_by_slot();
  void sort_slot(std::span<std::uint32_t> of_slot) const;
  [[nodiscard]] Fragment fragment(const Crossing& crossing) const;

  const RasterScene* scene_ = nullptr;
  const TriangleBins* bins_ = nullptr;
  std::int32_t width_ = 0, first_row_ = 0, last_row_ = 0;
  std::span<const SubPixel> pattern_;
  std::vector<std::uint32_t> slot_of_pixel_;  // the first; empty: every pixel has one
  std::vector<Crossing> nearest_;             // opaque, per slot; empty without opaque surfaces
  std::vector<Crossing> crossings_;           // translucent
  std::vector<Crossing> sorted_;              // by slot
  std::vector<std::uint32_t> end_of_slot_;    // in sorted_
  std::vector<std::uint32_t> order_;          // of sorted_, by depth within a slot
};

}  // namespace splatlas
