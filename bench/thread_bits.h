// Dependence of pictures on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "format/atlas_reader.h"
#include "player/render_frame.h"

namespace splatlas {

/// A mode of drawing.
struct DrawingMode {
  const char* name;
  const char* selection;  ///< for the Colin 27 atlas
  CameraProjection projection = CameraProjection::kParallel;
  RenderOptions options{};
};
[[nodiscard]] std::vector<DrawingMode> drawing_modes();

/// Number of values whose bits differ from those of one thread. `views` views, 25 degrees apart.
[[nodiscard]] Result<std::uint64_t> thread_bits_differ(const std::shared_ptr<const Atlas>& atlas,
                                                       const DrawingMode& mode,
                                                       std::span<const unsigned> threads, int views);

}  // namespace splatlas
