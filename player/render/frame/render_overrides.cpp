#include "player/render/frame/render_overrides.h"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "format/result_macros.h"

namespace splatlas {

Result<Shear> shear_of(const ParallelView& view, const Grid& grid, const RenderOverrides& overrides) {
  const Shear shear = factorise(view, grid, overrides.principal_axis ? &*overrides.principal_axis : nullptr);
  if (std::abs(shear.slope_u) <= kMaxForcedSlope && std::abs(shear.slope_v) <= kMaxForcedSlope) return shear;
  return fail(ErrorCode::kUsage,
              fmt::format("principal axis {}: the view runs along its slices; take another",
                          "xyz"[static_cast<std::size_t>(shear.principal)]));
}

}  // namespace splatlas
