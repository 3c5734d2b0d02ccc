// A-buffer rasteriser of a band of picture rows (Carpenter 1984).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "player/render/surfaces/edge_pixels.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/surfaces/raster_scene.h"
#include "player/render/surfaces/screen_triangle.h"
#include "player/render/surfaces/triangle_bins.h"

namespace splatlas {

/// The visible fragments of a band by slot, front to back.
struct BandFragments {
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> end_of_slot;

  [[nodiscard]] std::size_t begin_of(std::size_t slot) const { return slot == 0 ? 0 : end_of_slot[slot - 1]; }
  [[nodiscard]] std::span<const Fragment> of_slot(std::size_t slot) const {
    return std::span(fragments).subspan(begin_of(slot), end_of_slot[slot] - begin_of(slot));
  }
};

/// Faces of a cut by slot; empty: none.
struct SlotFaces {
  std::span<const Face> front, back;
};

/// Rasteriser of one band after another; keeps its memory between bands. A slot is a sample position with a
/// list of crossings. Not thread-safe.
class BandRasterizer {
 public:
  /// Begins a band with one slot per pixel of rows [first_row, last_row), at its centre.
  void begin(const RasterScene& scene, const TriangleBins& bins, int first_row, int last_row);
  /// Begins a band with one slot per point of `pattern` in every pixel whose `wanted` flag is not 0. `wanted`
  /// has width * rows flags. `pattern` must outlive the band.
  void begin_edges(const RasterScene& scene, const TriangleBins& bins, int first_row, int last_row,
                   std::span<const std::uint8_t> wanted, std::span<const SubPixel> pattern);
  /// Rasterises a triangle. Opaque surfaces should come first, so that hidden crossings are never shaded.
  void draw(const TriangleRef& ref);
  /// Sorts fragments by slot and depth. A slot ends once its transmittance is at most
  /// `termination_threshold`, such as behind an opaque fragment. `seen` receives a summary of every slot
  /// unless it is empty. `faces` of a cut are in front of and behind all fragments.
  void finish(float termination_threshold, BandFragments& out, std::span<SurfacesSeen> seen,
              const SlotFaces& faces = {});

  /// Number of translucent crossings so far; after finish(), with the visible opaque ones.
  [[nodiscard]] std::size_t crossings() const { return crossings_.size(); }
  [[nodiscard]] std::size_t slots() const { return end_of_slot_.size(); }

 private:
  /// Intersection of a surface with the ray of a slot.
  struct Crossing {
    std::uint64_t order = 0;  ///< sort key: depth bin, then back faces before front faces
    std::uint32_t slot = 0;
    float depth = 0;
    std::uint32_t surface = kNone;
    std::uint32_t triangle = 0;
    /// Diffuse and highlight. For opaque crossings until take_opaque(): the barycentric weights of the second
    /// and third corner, as shading is deferred.
    std::array<float, 2> shading{};
  };
  static constexpr std::uint32_t kNone = 0xffffffff;

  void clear(std::size_t slots);
  void sample_centers(const ScreenTriangle& t);
  void sample_patterns(const ScreenTriangle& t);
  [[nodiscard]] bool is_hidden(const ScreenTriangle& t, std::uint32_t slot) const;
  /// Pixels of the band.
  [[nodiscard]] PixelBox band() const { return {0, width_ - 1, first_row_, last_row_ - 1}; }
  [[nodiscard]] bool in_front(const Crossing& a, const Crossing& b) const;
  /// `x`, `y`: the slot's sample, with integer pixel centres.
  [[nodiscard]] bool is_cut_away(double x, double y, double depth) const;
  void add(const ScreenTriangle& triangle, const TriangleAttributes& attributes, std::uint32_t slot,
           std::array<float, 3> weight, double depth);
  [[nodiscard]] SurfaceShading shade(const SurfaceMesh& mesh, std::uint32_t triangle, bool front,
                                     const std::array<float, 3>& weight) const;
  void take_opaque();
  void sort_by_slot();
  void sort_slot(std::span<std::uint32_t> of_slot) const;
  [[nodiscard]] Fragment fragment(const Crossing& crossing) const;

  const RasterScene* scene_ = nullptr;
  const TriangleBins* bins_ = nullptr;
  const CutRays* cuts_ = nullptr;  // of the current triangle; null if it is kept whole
  std::int32_t width_ = 0, first_row_ = 0, last_row_ = 0;
  std::span<const SubPixel> pattern_;
  std::vector<std::uint32_t> slot_of_pixel_;  // first slot; empty if every pixel has one slot
  std::vector<Crossing> nearest_;             // opaque crossing of each slot; empty without opaque surfaces
  std::vector<Crossing> crossings_;           // translucent
  std::vector<Crossing> sorted_;              // by slot
  std::vector<std::uint32_t> end_of_slot_;    // in sorted_
  std::vector<std::uint32_t> order_;          // of sorted_, by depth within a slot
};

}  // namespace splatlas
