// Where a transfer function stands: before or behind interpolation between voxels.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace splatlas {

enum class Classification : std::uint8_t {
  kBefore,  ///< voxels are classified; what they emit and absorb is interpolated: class colours, speed
  kAfter,   ///< grey values are interpolated, and classified then: sharp transfer functions
};
/// "before", "after".
[[nodiscard]] inline std::optional<Classification> named_classification(std::string_view name) {
  if (name == "before") return Classification::kBefore;
  if (name == "after") return Classification::kAfter;
  return std::nullopt;
}

}  // namespace splatlas
