// VTK as a peer: its two volume mappers, and surfaces with depth peeling.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "format/content/surface.h"
#include "format/result.h"
#include "player/camera.h"
#include "player/picture.h"
#include "tests/reference/masked_volume.h"
#include "tests/reference/ray.h"

namespace splatlas {

/// Ends Xvfb, which DISPLAY names until then.
using XServer = std::shared_ptr<const void>;

/// Starts Xvfb (Debian package xvfb) at a free display number, as VTK cannot draw without a display; once at
/// a time. Starts nothing if DISPLAY is set. kFailed without Xvfb.
[[nodiscard]] Result<XServer> start_x_server();

enum class VtkVolumeMapper : std::uint8_t {
  kFixedPoint,  ///< vtkFixedPointVolumeRayCastMapper: on the CPU, two threads, 15 bits
  kGpu,         ///< vtkOpenGLGPUVolumeRayCastMapper, on the OpenGL of the display
};

/// An off-screen VTK window with volumes and surfaces. Unlit by default, no adjustment for frame rates, no
/// multisampling. Needs a display (start_x_server()). Both mappers interpolate grey values trilinearly and
/// post-classify them. Copies share their state.
class VtkPeer {
 public:
  explicit VtkPeer(const PictureSize& size);

  /// Copies the volume with a layer of 0 around it, as the volume is empty outside its grid. Samples are
  /// `step_mm` apart.
  void add_volume(const reference::MaskedVolume& volume, const reference::GreyAppearance& appearance,
                  VtkVolumeMapper mapper, double step_mm);
  /// Replaces the voxels of the latest volume; grid and appearance stay.
  void replace_volume(const reference::MaskedVolume& volume);
  /// Lights all volumes by the gradients of their grey values and VTK's light at the camera, or none:
  /// diffuse, with the ambient share of the model. The next picture includes the calculation of the
  /// gradients.
  void shade_volumes(bool lit);
  /// Unlit. `color`: linear RGB, used as is.
  void add_surface(const SurfaceMesh& mesh, const Grid& grid, const std::array<double, 3>& color,
                   double opacity);
  /// Composites translucent surfaces and volumes in exact order by dual depth peeling (at most 100 layers).
  void peel_depths();

  /// Draws, and waits for completion.
  void render(const ParallelView& view);
  void render(const reference::PerspectiveView& view);
  /// The latest picture, of 8 bits, as floats. For a single FixedPoint volume, the 15-bit image of its rays:
  /// VTK stretches it by about a pixel on the way to the window.
  [[nodiscard]] Picture picture() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace splatlas
