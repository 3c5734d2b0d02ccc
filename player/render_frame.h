// Renders selections of an atlas: the way in for programs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "format/atlas_reader.h"
#include "format/selection.h"
#include "player/camera.h"
#include "player/classification.h"
#include "player/depth_cue.h"
#include "player/missing_parts.h"
#include "player/picture.h"
#include "player/stopwatch.h"

namespace splatlas {

/// Sheets, in parallel projection with voxels classified before interpolation: pixels per voxel, along each
/// axis, are about as many as the picture's in drafts, at most 2; 1.5 times as many normally, at most 4;
/// twice as many in high quality, at most 8. Selections whose voxels absorb 1 and more where they are
/// densest, on average (opacity 0.63), have sharp edges and get 2.25 times as many normally, at most 6, and
/// 2.5 times as many in high quality. Slabs per slice are 1, 4 and 8, and where there is volume alone, sheets
/// are warped with a cubic but in drafts. Rays, in perspective and wherever grey values are classified after
/// interpolation: steps per slab are 1; 1 to 32; 8 to 64.
enum class Quality : std::uint8_t { kDraft, kNormal, kHigh };
[[nodiscard]] std::optional<Quality> named_quality(std::string_view name);

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
  bool simd = true;                 ///< false: the scalar kernels
  /// Early termination: what would be seen through pixels that let through no more than this is left out, so
  /// no value is further off than that. 0 leaves nothing out.
  /// Not set: 1e-3 in drafts, 1e-4 otherwise.
  std::optional<float> transmittance_floor = std::nullopt;
  /// Forced, to measure what the choice costs; the best one when not set.
  std::optional<Axis> principal_axis = std::nullopt;
};

/// The floor that counts.
[[nodiscard]] inline float transmittance_floor(const RenderOptions& options) {
  return options.transmittance_floor.value_or(options.quality == Quality::kDraft ? 1e-3f : 1e-4f);
}

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

/// What is under a point of the picture.
struct Pick {
  StructureIndex structure = kNoStructure;
  Vec3 point_lps_mm{0, 0, 0};
};

/// An atlas with one selection. Keeps what it has decoded: a new selection reads only what is new.
/// Not for use by several threads at once; works on its own threads inside.
class Renderer {
 public:
  explicit Renderer(std::shared_ptr<const Atlas> atlas, const RendererOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  [[nodiscard]] const Atlas& atlas() const;

  /// Changes what is drawn. Reading and decoding wait until a view is rendered. kLimit, and the old selection
  /// stays, when it would need more memory than allowed; kLimit, and nothing is selected, when there is none.
  [[nodiscard]] Result<void> select(const Selection& selection);

  /// Renders the selection. Same selection, camera and options: same bits, with any number of threads.
  /// kLimit, before anything is read or allocated, when the picture would need more memory than allowed, and
  /// when there is no more: the selection stays, and what was decoded.
  /// Where the file is damaged, the rest is drawn: see missing(). An error where nothing is left to draw.
  /// Cost: selected voxels in view * sheet pixels per voxel * slabs per slice, selected triangles, pixels;
  /// after a change of selection also the decoded runs in its box.
  [[nodiscard]] Result<Picture> render(const Camera& camera, const RenderOptions& options = {});
  /// The same into a picture whose memory is reused: fresh pages cost as much as a small frame. On failure
  /// the picture holds anything.
  [[nodiscard]] Result<void> render(const Camera& camera, const RenderOptions& options, Picture& picture);

  /// Of the latest render().
  [[nodiscard]] const RenderStats& stats() const;
  /// What the pictures of the current selection lack, as far as it has been needed: empty but for damaged
  /// files. Tried again after the next change of selection.
  [[nodiscard]] const std::vector<MissingPart>& missing() const;

  /// The structure that contributes most to the picture at picture coordinates (x, y) of the latest render(),
  /// and where on the ray; nothing where the background shows. In frames of sheets and of rays. Cost: one
  /// look-up per slice.
  [[nodiscard]] std::optional<Pick> pick(double x, double y) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
