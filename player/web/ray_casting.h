// Ray casting is optional in a module: it takes half of the size and of the compile time.
#pragma once

namespace splatlas {

/// True in splatlas-rays.wasm.
[[nodiscard]] bool has_ray_casting();

}  // namespace splatlas
