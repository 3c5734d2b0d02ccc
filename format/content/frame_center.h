// Framing of a picture: standard anatomical views, and its middle as text.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "format/content/grid.h"

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

/// Middle of a picture: that of the fit, a point in LPS mm, or a name of the selection language.
using FrameCenter = std::variant<std::monostate, Vec3, std::string>;

/// Parses X,Y,Z, each at most kMaxMm from 0, or takes the name of a structure. None for other points and for
/// no text.
[[nodiscard]] std::optional<FrameCenter> parse_center(std::string_view text);

}  // namespace splatlas
