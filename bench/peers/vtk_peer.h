// VTK as a peer: its two volume renderers, and surfaces with depth peeling.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "format/surface.h"
#include "player/camera.h"
#include "player/picture.h"
#include "tests/reference/masked_volume.h"
#include "tests/reference/perspective.h"

namespace splatlas {

enum class VtkVolumeMapper : std::uint8_t {
  kFixedPoint,  ///< vtkFixedPointVolumeRayCastMapper: on the CPU, two threads, 15 bits
  kGpu,         ///< vtkOpenGLGPUVolumeRayCastMapper, here on whatever OpenGL the display has
};

/// A window of VTK's, off screen, with volumes and surfaces in it. Nothing is shaded, nothing is adjusted for
/// the sake of frame rates, there is no multisampling. Needs a display (x_server.h). Both mappers interpolate
/// grey values trilinearly and classify them afterwards.
class VtkPeer {
 public:
  explicit VtkPeer(const PictureSize& size);
  ~VtkPeer();
  VtkPeer(VtkPeer&&) noexcept;
  VtkPeer& operator=(VtkPeer&&) noexcept;

  /// Copies the volume, with a layer of 0 around it: beyond its grid there is nothing, as everywhere else.
  /// Samples are `step_mm` apart.
  void add_volume(const reference::MaskedVolume& volume, const reference::GreyAppearance& appearance,
                  VtkVolumeMapper mapper, double step_mm);
  /// Other voxels for the volume that was added last, in the same grid and look.
  void replace_volume(const reference::MaskedVolume& volume);
  /// Unlit. `color`: linear light, taken as it is.
  void add_surface(const SurfaceMesh& mesh, const Grid& grid, const std::array<double, 3>& color,
                   double opacity);
  /// Translucent surfaces in exact order, by dual depth peeling (at most 100 layers), volumes among them.
  void peel_depths();

  /// Draws, and waits until it is done.
  void render(const ParallelView& view);
  void render(const reference::PerspectiveView& view);
  /// The latest picture, of 8 bits, as floats. Where there is only a volume drawn by FixedPoint, the picture
  /// of 15 bits that it casts its rays into: on its way to the window VTK stretches it by about a pixel.
  [[nodiscard]] Picture picture() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
