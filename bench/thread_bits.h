// Whether pictures depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "format/atlas_reader.h"
#include "player/render_frame.h"

namespace splatlas {

/// A way to draw, of all that there are.
struct DrawingMode {
  const char* name;
  const char* selection;  ///< of the Colin 27 atlas
  CameraProjection projection = CameraProjection::kParallel;
  RenderOptions options{};
};
[[nodiscard]] std::vector<DrawingMode> drawing_modes();

/// Values of all pictures whose bits are not those that one thread draws. `views` views, 25 degrees apart.
[[nodiscard]] Result<std::uint64_t> thread_bits_differ(const std::shared_ptr<const Atlas>& atlas,
                                                       const DrawingMode& mode,
                                                       std::span<const unsigned> threads, int views);

}  // namespace splatlas
