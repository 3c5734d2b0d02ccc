// What makes depth readable beyond light on surfaces.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace splatlas {

enum class DepthCue : std::uint8_t {
  kNone,   ///< for measurements
  kEdges,  ///< what lies behind something near it is darker there, and so are furrows
};
/// "none", "edges".
[[nodiscard]] inline std::optional<DepthCue> named_depth_cue(std::string_view name) {
  if (name == "none") return DepthCue::kNone;
  if (name == "edges") return DepthCue::kEdges;
  return std::nullopt;
}

}  // namespace splatlas
