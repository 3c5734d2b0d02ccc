// A sample of the picture in a sheet.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "player/render/surfaces/fragments.h"

namespace splatlas {

/// A sample of the picture in the sheet, and what is composited of its fragments.
struct SheetSample {
  static constexpr std::uint32_t kNoBand = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t band = kNoBand;       ///< of its upper neighbours; kNoBand without neighbours in the sheet
  std::uint32_t left = 0, right = 0;  ///< the upper neighbours, in floats from the begin of the band's image
  std::array<float, 4> weights{};     ///< of the four neighbours: sheet_weights(); 0 outside the sheet
  Radiance sum;                       ///< of the fragments, and of the volume in front of the last one
  Radiance volume;                    ///< in front of the last fragment
  float transmittance = 1;            ///< of the fragments

  /// Composites the next fragment (Porter and Duff 1984). `in_front`: the volume in front of it.
  void add(const Fragment& fragment, const Radiance& in_front) {
    const float clear = 1 - in_front.rgba[3];
    for (std::size_t c = 0; c < 4; ++c)
      sum.rgba[c] += transmittance * (in_front.rgba[c] - volume.rgba[c] + clear * fragment.rgba[c]);
    volume = in_front;
    transmittance *= 1 - fragment.rgba[3];
  }
  /// The finished sample, in the whole volume.
  [[nodiscard]] Radiance in(const Radiance& whole) const {
    Radiance all = sum;
    for (std::size_t c = 0; c < 4; ++c) all.rgba[c] += transmittance * (whole.rgba[c] - volume.rgba[c]);
    return all;
  }
};

}  // namespace splatlas
