// VolPack, Lacroute's shear-warp renderer, as a peer: the fastest CPU volume renderer in Debian.
#pragma once

#include <memory>
#include <utility>

#include "format/result.h"
#include "player/camera.h"
#include "player/picture.h"
#include "tests/reference/masked_volume.h"

namespace splatlas {

/// VolPack 1.0 in its fastest mode: pre-classified runs along all three axes, look-up shading, opacities
/// corrected for the view direction, early ray termination at an opacity of 0.999 (or as requested). One
/// thread, parallel projection, 8-bit colours, and opacities rounded down to 255ths: thin fog vanishes.
/// Copies share their state.
class VolpackPeer {
 public:
  /// Classifies: opacity 1 - exp(-extinction * voxel) and colour of every grey value. Boundary voxels have
  /// the model's diffuse factor by the normals of the volume, in VolPack's code for normals (7924
  /// directions): a shade table for each direction of view, weighted by the shade of the grey value. Voxels
  /// must be cubes, all colours of one hue. Keeps no reference to the volume.
  [[nodiscard]] static Result<VolpackPeer> classify(const reference::MaskedVolume& volume,
                                                    const reference::GreyAppearance& appearance);

  /// Draws into its own 8-bit picture. Fills the shade table if the view's lighting has changed.
  [[nodiscard]] Result<void> render(const ParallelView& view);
  /// The latest picture, as floats.
  [[nodiscard]] Picture picture() const;

 private:
  struct Impl;
  explicit VolpackPeer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<Impl> impl_;
};

}  // namespace splatlas
