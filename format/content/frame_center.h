// The middle of a picture, as text.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "format/content/grid.h"

namespace splatlas {

/// Middle of a picture: that of the fit, a point in LPS mm, or a name of the selection language.
using FrameCenter = std::variant<std::monostate, Vec3, std::string>;

/// Parses X,Y,Z, each at most kMaxMm from 0, or takes the name of a structure. None for other points and for
/// no text.
[[nodiscard]] std::optional<FrameCenter> parse_center(std::string_view text);

}  // namespace splatlas
