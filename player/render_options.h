// Options and counters of a rendered frame.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>

#include "format/content/cut_planes.h"
#include "format/content/grid.h"
#include "player/camera.h"

namespace splatlas {

/// Order of classification (application of the transfer function) and interpolation between voxels.
enum class Classification : std::uint8_t {
  kBefore,  ///< pre-classification: interpolates optical properties; for speed and class colours
  kAfter,   ///< post-classification: interpolates grey values; for sharp transfer functions
};

/// Depth cues in addition to shading.
enum class DepthCue : std::uint8_t {
  kNone,   ///< unchanged colours, for measurements
  kEdges,  ///< depth darkening (Luft et al. 2006): darkens pixels behind nearer neighbours
};

/// Quality of a picture: draft, normal, high.
///
/// Sheets draw parallel projections with pre-classification, rays all else. In high quality, rays draw all
/// volumes without cuts along the view, if memory allows. Sheets have:
///   - Sheet pixels per picture pixel, along each axis: 1, 1.5, 2. Sheet pixels per voxel: at most 2, 4, 8.
///   - Selections with sharp edges: 1, 2.25, 2.5; at most 2, 6, 8 per voxel. Their maximum
///     optical depth over the reference length is at least 1 (opacity 0.63) on average.
///   - Slabs per slice: 1, 4, 8.
///   - Interpolation in pixels without surfaces: bilinear, bicubic, bicubic.
///
/// Rays have 1, 1 to 32, 8 to 64 steps per slab. Where voxels are less than a pixel wide, a pixel has 1, n x
/// n, 1.5 n x 1.5 n rays, with n voxels along a pixel.
enum class Quality : std::uint8_t { kDraft, kNormal, kHigh };

/// Contents of the faces of a cut: the points where a plane meets drawn structures.
enum class CapMode : std::uint8_t {
  kValues,  ///< grey values through the display window
  kLabels,  ///< colours of structures
  kBoth,    ///< the luminance of grey values, with the hues of structures
  kNone,    ///< no faces: cut surfaces are hollow
};

/// Options of one picture.
struct RenderOptions {
  PictureSize size{512, 512};
  Quality quality = Quality::kNormal;
  Classification classification = Classification::kBefore;
  /// Time for a draft, in ms; 0: as much as it takes. Within a budget, without ids, depths and depth cue:
  ///   - Rays end where the nearest pixel centre meets an opaque surface or face of a cut: several times as
  ///     fast; silhouettes in the volume are rough by a pixel.
  ///   - After a draft that took longer, sheets have one pixel per voxel, and then pre-classified volumes are
  ///     drawn from means of 2^n voxels along each axis, at most 6 picture pixels wide.
  ///   - Surfaces are those of blocks of 2^n voxels, at most 3 pixels wide, or 6 after a late draft.
  ///   - Means and blocks also stand in for what would take twice the budget to prepare.
  double draft_budget_ms = 0;
  bool hybrid_shading = true;  ///< lights volumes by their borders and grey values
  /// Supersamples pixels at edges of surfaces: 1 sample in draft, 4 in normal, 8 in high quality. Pictures
  /// that need more than a quarter of the allowed memory for edge detection get 1 sample.
  bool antialiasing = true;
  /// Depth cue of colours. Alpha and background never change.
  DepthCue depth_cue = DepthCue::kNone;
  float depth_cue_strength = 0.7f;  ///< 0 or less: no effect; 1 or more: darkens down to black
  /// Early ray termination threshold: pixels stop once their transmittance falls to this value, which bounds
  /// the error of each channel. 0 disables termination. Not set: 1e-3 in drafts, 1e-4 otherwise.
  std::optional<float> termination_threshold = std::nullopt;
  /// Half spaces to remove from volumes and surfaces. What remains is unchanged.
  CutPlanes cuts = {};
  CapMode caps = CapMode::kBoth;  ///< faces of the cuts
  bool ids = false;               ///< also makes Frame::ids; the picture is the same
  bool depths = false;            ///< also makes Frame::depths; the picture is the same
};

/// Cancellation of one call of Renderer::render() or fit(), and progress of render().
struct RenderControl {
  /// A stop request ends the call with kCancelled within milliseconds.
  std::stop_token stop = {};
  /// Called on the thread of render() with rising fractions from 0 to 1; 1 when the picture is finished. May
  /// request the stop; must not call the renderer.
  std::function<void(double)> progress = {};
};

/// The termination threshold of these options, with the default of the quality if not set.
[[nodiscard]] inline float termination_threshold(const RenderOptions& options) {
  return options.termination_threshold.value_or(options.quality == Quality::kDraft ? 1e-3f : 1e-4f);
}

/// Wall-clock and CPU time of a stage, in ms. CPU time covers all threads of the process.
struct Elapsed {
  double wall_ms = 0, cpu_ms = 0;

  Elapsed& operator+=(const Elapsed& other) {
    wall_ms += other.wall_ms;
    cpu_ms += other.cpu_ms;
    return *this;
  }
  friend Elapsed operator+(Elapsed a, const Elapsed& b) { return a += b; }
};

/// Counters and times of a frame and its selection.
struct RenderStats {
  std::uint64_t volume_voxels = 0, surface_voxels = 0,
                hybrid_voxels = 0;   ///< k_vol, k_sur, k_hyb (paper, table 2)
  double occupancy = 0;              ///< sum of the three over the voxels of the grid
  std::uint64_t runs_visited = 0;    ///< runs of selected classes
  std::uint64_t voxels_visited = 0;  ///< splatted voxels, or voxels of the ray volume
  int level = 0;                     ///< voxels of the volume are means of 2^level along each axis
  int surface_level = 0;             ///< surfaces are those of blocks of 2^level voxels
  bool rays = false;                 ///< the volume is drawn by rays, not by sheets
  bool strips = false;               ///< spans were built strip by strip, as memory does not hold all
  std::uint64_t triangles = 0;       ///< projected triangles
  double select_ms = 0, decode_ms = 0, render_ms = 0;
  /// Stages:
  ///   - traversal: merges runs to spans, or builds the ray volume, once per selection; lights voxels.
  ///   - rasterize: surfaces to fragments, or to pixels; depth_cue: darkening.
  ///   - sheets: splatting and compositing of sheets, or ray casting.
  ///   - resolve: warps the sheet and composites fragments.
  ///   - ids: walk of rays for ids and depths beside sheets. Pictures by rays find both on the way.
  Elapsed traversal, rasterize, sheets, resolve, ids, depth_cue;
};

/// Resources of a renderer.
struct RendererOptions {
  unsigned threads = 0;  ///< 0: one per core. Pictures do not depend on it.
  /// Limit for decoded parts, spans, fragments and the picture. A new selection first drops the decoded parts
  /// of earlier ones if both might exceed it. 0: half of physical memory, or of the process's limit
  /// (RLIMIT_AS, RLIMIT_DATA) if that is lower.
  std::uint64_t max_memory_bytes = 0;
};

}  // namespace splatlas
