// Standard anatomical views, for cameras and scenes.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace splatlas {

/// Named after the side of the subject that faces the viewer.
enum class NamedView : std::uint8_t { kAnterior, kPosterior, kLeft, kRight, kSuperior, kInferior };

/// Name and angles of a view.
struct ViewAngles {
  std::string_view name;
  double azimuth_deg, elevation_deg;
};

/// In the order of NamedView. Superior and inferior views have anterior up.
inline constexpr std::array<ViewAngles, 6> kViewAngles{{{"anterior", 0, 0},
                                                        {"posterior", 180, 0},
                                                        {"left", 90, 0},
                                                        {"right", -90, 0},
                                                        {"superior", 180, 90},
                                                        {"inferior", 0, -90}}};

}  // namespace splatlas
