// Options and counters of a rendered frame.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

#include "format/grid.h"
#include "player/picture.h"

namespace splatlas {

/// Order of classification (the transfer function) and interpolation between voxels.
enum class Classification : std::uint8_t {
  kBefore,  ///< optical properties are interpolated (pre-classification): class colours, speed
  kAfter,   ///< grey values are interpolated, then classified (post-classification): sharp transfer functions
};

/// Depth cues beyond the shading of surfaces.
enum class DepthCue : std::uint8_t {
  kNone,   ///< for measurements
  kEdges,  ///< depth-darkened edges: a pixel darkens where it lies behind its neighbours
};

/// Sheets, in parallel projection with voxels classified before interpolation: pixels per voxel, along each
/// axis, are about as many as the picture's in drafts, at most 2; 1.5 times as many normally, at most 4;
/// twice as many in high quality, at most 8. Selections whose voxels absorb 1 and more where they are
/// densest, on average (opacity 0.63), have sharp edges and get 2.25 times as many normally, at most 6, and
/// 2.5 times as many in high quality. Slabs per slice are 1, 4 and 8, and where there is volume alone, sheets
/// are warped with a cubic but in drafts. Rays, in perspective and wherever grey values are classified after
/// interpolation: steps per slab are 1; 1 to 32; 8 to 64.
enum class Quality : std::uint8_t { kDraft, kNormal, kHigh };

struct RenderOptions {
  PictureSize size{512, 512};
  Quality quality = Quality::kNormal;
  Classification classification = Classification::kBefore;
  bool hybrid_shading = true;  ///< boundary voxels of volumes are shaded by their normals
  /// Pixels at edges of surfaces are the mean of several samples: 4 in normal, 8 in high quality, 1 in draft,
  /// and in pictures for which finding edges would take more than a quarter of the memory allowed.
  bool antialiasing = true;
  /// What makes depth readable: none where colours are measured. Alpha and background never change.
  DepthCue depth_cue = DepthCue::kNone;
  float depth_cue_strength = 0.7f;  ///< 0 and less: the same bits as without; 1 and more: down to black
  /// Early termination: what would be seen through pixels that let through no more than this is left out, so
  /// no value is further off than that. 0 leaves nothing out.
  /// Not set: 1e-3 in drafts, 1e-4 otherwise.
  std::optional<float> termination_threshold = std::nullopt;
};

/// Cancellation and progress of one call of Renderer::render().
struct RenderControl {
  /// A requested stop ends the call with kCancelled within milliseconds.
  std::stop_token stop = {};
  /// Called by the calling thread with rising fractions from 0 to 1; 1 when the picture is finished. May
  /// request the stop; must not call the renderer.
  std::function<void(double)> progress = {};
};

/// The floor that counts.
[[nodiscard]] inline float termination_threshold(const RenderOptions& options) {
  return options.termination_threshold.value_or(options.quality == Quality::kDraft ? 1e-3f : 1e-4f);
}

/// Wall-clock and CPU time of a stage. CPU time is the whole process's, all threads together.
struct Elapsed {
  double wall_ms = 0, cpu_ms = 0;

  Elapsed& operator+=(const Elapsed& other) {
    wall_ms += other.wall_ms;
    cpu_ms += other.cpu_ms;
    return *this;
  }
  friend Elapsed operator+(Elapsed a, const Elapsed& b) { return a += b; }
};

struct RenderStats {
  std::uint64_t volume_voxels = 0, surface_voxels = 0,
                hybrid_voxels = 0;   ///< k_vol, k_sur, k_hyb (paper, table 2)
  double occupancy = 0;              ///< their sum over the grid's voxels
  std::uint64_t runs_visited = 0;    ///< of selected classes
  std::uint64_t voxels_visited = 0;  ///< splatted
  std::uint64_t triangles = 0;       ///< projected
  double select_ms = 0, decode_ms = 0, render_ms = 0;
  /// Stages of the latest frame: runs merged to spans (once per selection and axis) and lit; surfaces to
  /// fragments; spans to the finished sheet; sheet and fragments to the picture; depths and what they darken.
  Elapsed traversal, rasterize, sheets, resolve, depth_cue;
};

struct RendererOptions {
  unsigned threads = 0;  ///< 0: one per core. Pictures do not depend on it.
  /// For decoded voxels, spans, fragments and the picture. 0: three quarters of the machine's memory, or of
  /// what the process may have (RLIMIT_AS, RLIMIT_DATA) where that is less.
  std::uint64_t max_memory_bytes = 0;
};

}  // namespace splatlas
