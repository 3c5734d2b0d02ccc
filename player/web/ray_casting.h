// Whether a module is linked with ray casting: half of its size, and of the time to compile it.
#pragma once

namespace splatlas {

/// True in splatlas-rays.wasm.
[[nodiscard]] bool has_ray_casting();

}  // namespace splatlas
