// VolPack, Lacroute's own shear-warp renderer, as a peer: the fastest volume renderer on a plain CPU that
// Debian has.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "format/result.h"
#include "player/camera.h"
#include "player/picture.h"
#include "tests/reference/masked_volume.h"

namespace splatlas {

/// VolPack keeps opacities as whole 255ths, rounded down: thin fog turns into less fog, or none.
enum class OpacityRounding : std::uint8_t {
  kDown,     ///< VolPack as it is documented
  kNearest,  ///< opacities are handed over as the 255ths that they are nearest to: the best that VolPack can
             ///< do
};

/// VolPack 1.0 in its fastest way: classified beforehand into runs along all three axes, shaded through a
/// look-up table, opacities corrected for the direction of the view, rays given up at an opacity of 0.999 (or
/// what is asked for). It works on one thread, in parallel projection, and keeps opacities and colours in 8
/// bits.
class VolpackPeer {
 public:
  /// Classifies: opacity 1 - exp(-extinction * voxel) and colour of every grey value. kFailed when voxels are
  /// no cubes, or a side has more than VolPack's 1024. Keeps no reference to the volume.
  [[nodiscard]] static Result<VolpackPeer> classify(const reference::MaskedVolume& volume,
                                                    const reference::GreyAppearance& appearance,
                                                    OpacityRounding rounding);
  ~VolpackPeer();
  VolpackPeer(VolpackPeer&&) noexcept;
  VolpackPeer& operator=(VolpackPeer&&) noexcept;

  /// Draws into its own picture of 8 bits.
  [[nodiscard]] Result<void> render(const ParallelView& view);
  /// The latest picture, as floats.
  [[nodiscard]] Picture picture() const;

  /// Of the runs along all axes, classified voxels included.
  [[nodiscard]] std::uint64_t classified_bytes() const;

 private:
  struct Impl;
  explicit VolpackPeer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
