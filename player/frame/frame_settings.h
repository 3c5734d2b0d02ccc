// Settings of the rasteriser and of rays, and memory, for the options of a frame.
#pragma once

#include <cstdint>

#include "player/frame/render_overrides.h"
#include "player/rays/cast_rays.h"
#include "player/render_options.h"
#include "player/surfaces/rasterize.h"

namespace splatlas {

[[nodiscard]] bool cues_depth(const RenderOptions& options);

/// Memory of a picture on its way to a file, and of its depths.
[[nodiscard]] std::uint64_t frame_bytes(const RenderOptions& options);

/// Samples at edges; fragments may take a quarter of the memory.
[[nodiscard]] RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes);

/// Steps and error tolerance of ray marching at the quality asked for.
[[nodiscard]] CastOptions cast_options(const RenderOptions& options, const RenderOverrides& overrides);

}  // namespace splatlas
