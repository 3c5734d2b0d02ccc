// Frames of benches: cameras, qualities, decoded volumes, drawing and comparison.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "player/render/decode/class_cache.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/frame/sheet_frame.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

/// Quality of the renderer, for table rows.
struct NamedQuality {
  const char* name;
  Quality quality;
  bool antialiasing = true;
};
inline constexpr std::array kQualities{NamedQuality{"draft", Quality::kDraft},
                                       NamedQuality{"normal", Quality::kNormal},
                                       NamedQuality{"high", Quality::kHigh}};

/// Off all symmetries: neither slices nor rays align with voxels.
[[nodiscard]] Camera oblique_camera();

/// The camera of a turn, which draws frame `turn % frames`: 15 degrees per frame, and a further degree per
/// repeat, so that no view repeats.
[[nodiscard]] Camera turned(Camera camera, int turn, int frames);

/// The first camera of each principal axis among `turns` turns. Drawn in advance, they build all spans.
[[nodiscard]] Result<std::vector<Camera>> cameras_by_axis(const Camera& camera, int turns, int frames,
                                                          const Atlas& atlas);

/// Runs the stages of the player, except the depth cue, without a limit of memory, and returns their
/// statistics. kLimit as for the stages.
[[nodiscard]] Result<RenderStats> draw_frame(FrameScene scene, const SpanModel& spans, const Shear& shear,
                                             FrameBuffers& buffers, Picture& picture, ThreadPool& pool);

/// Number of values that differ in their bits; with unequal lengths, the length of the longer.
[[nodiscard]] std::uint64_t bits_differ(std::span<const float> a, std::span<const float> b);

}  // namespace splatlas
