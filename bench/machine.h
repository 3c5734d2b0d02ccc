// Description of the machine and the build.
#pragma once

#include <nlohmann/json.hpp>

namespace splatlas {

/// {"cpu", "cores", "simd" (the selected kernels), "compiler", "build_type", "date" (UTC)}.
[[nodiscard]] nlohmann::ordered_json describe_machine();

}  // namespace splatlas
