// Rasteriser settings, ray settings and memory of a frame.
#pragma once

#include <cstdint>

#include "player/frame/render_overrides.h"
#include "player/rays/cast_rays.h"
#include "player/render_options.h"
#include "player/surfaces/rasterize.h"

namespace splatlas {

/// True if the options ask for a visible depth cue.
[[nodiscard]] bool cues_depth(const RenderOptions& options);

/// Bytes of a picture, of its encoder and of its depth map.
[[nodiscard]] std::uint64_t frame_bytes(const RenderOptions& options);

/// Samples per edge pixel and maximum number of fragments. Fragments may take a quarter of the memory.
[[nodiscard]] RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes);

/// Steps per slab and error tolerance of ray marching at the quality of the options.
[[nodiscard]] CastOptions cast_options(const RenderOptions& options, const RenderOverrides& overrides);

}  // namespace splatlas
