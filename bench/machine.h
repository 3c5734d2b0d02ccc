// The machine and the build that measured.
#pragma once

#include <nlohmann/json.hpp>

namespace splatlas {

/// {"cpu", "cores", "simd" (the kernels that are chosen here), "compiler", "build_type", "date" (UTC)}.
[[nodiscard]] nlohmann::ordered_json describe_machine();

}  // namespace splatlas
