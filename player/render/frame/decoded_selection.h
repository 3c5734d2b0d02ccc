// Decoded and missing classes and surfaces of a selection, and the faces of its latest cut.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "player/picture.h"
#include "player/render/clip/cut_faces.h"
#include "player/render/clip/face_map.h"
#include "player/render/decode/class_cache.h"
#include "player/render/frame/draft_pace.h"
#include "player/render/frame/drawn_selection.h"
#include "player/render_options.h"

namespace splatlas {

/// Decodes classes and surfaces on demand, and caches them. Not thread-safe.
class DecodedSelection {
 public:
  explicit DecodedSelection(std::shared_ptr<const Atlas> atlas) : atlas_(std::move(atlas)), cache_(atlas_) {}

  /// Level of a plan's surfaces in the next draft within a budget. `voxel_pixels`: Shear::voxel_pixels().
  [[nodiscard]] int surface_level(const DrawPlan& plan, double voxel_pixels, const RenderOptions& options,
                                  const ThreadPool& pool);
  /// Records the times of the frame of the latest surface_level().
  void took(const RenderStats& stats, const RenderOptions& options);

  /// Level at which all surfaces of a plan can be derived in half a second: depends on their triangles alone.
  [[nodiscard]] int quick_level(const DrawPlan& plan) const;
  /// True if the values of the plan take long to decode, while their means are stored: blocks of voxels
  /// should stand in for them in a draft within a budget. `voxel_pixels`: Shear::voxel_pixels().
  [[nodiscard]] bool waits_for_values(const DrawPlan& plan, double voxel_pixels, const RenderOptions& options,
                                      const ThreadPool& pool) const;
  /// Reads and decodes a plan's uncached surfaces and parts of classes along `axis`. Lists damaged parts in
  /// missing(), and returns the plan without them; none if all are intact. kLimit when out of memory.
  [[nodiscard]] Result<std::optional<DrawPlan>> require(const DrawPlan& plan, Axis axis, VoxelParts parts,
                                                        int surface_level, ThreadPool& pool);
  /// Lights the voxels of a decoded plan (light_voxels()).
  void light(const DrawPlan& plan, const VolumeAppearances& appearances, ThreadPool& pool);
  /// Reads and decodes uncached classes of faces of a cut, after the plan's. Lists damaged ones in missing(),
  /// with the structures of `faces` (by ClassId), and succeeds. kLimit when out of memory.
  [[nodiscard]] Result<void> require_faces(std::span<const FaceClass> faces, Axis axis, ThreadPool& pool);
  /// Begins a new selection: clears missing(), so that require() tries these parts again. Keeps 64 MiB of
  /// surfaces of earlier ones. If all decoded parts take more than `bytes`, drops them and returns true.
  bool begin(const DrawPlan& plan, std::uint64_t bytes);

  [[nodiscard]] const ClassCache& cache() const { return cache_; }
  [[nodiscard]] const std::vector<MissingPart>& missing() const { return missing_; }

 private:
  void list_missing(MissingPart part);

  std::shared_ptr<const Atlas> atlas_;
  ClassCache cache_;
  SurfacePace pace_;
  std::vector<MissingPart> missing_;
};

/// Cache of the faces of the latest cut. Not thread-safe.
class FaceStore {
 public:
  /// Builds the faces that the options show, unless they are current. Reuses unchanged planes. Adds damaged
  /// classes to the missing parts of `decoded`. Errors and cost as for CutFaces::build().
  [[nodiscard]] Result<void> require(const RenderOptions& options, Axis axis, const Atlas& atlas,
                                     const DrawnSelection& drawn, DecodedSelection& decoded,
                                     ThreadPool& pool);
  /// Drops the faces. For a new plan. Does not throw.
  void clear() { faces_.reset(); }

  /// The current faces; null: none.
  [[nodiscard]] const std::shared_ptr<const CutFaces>& faces() const { return faces_; }

 private:
  std::shared_ptr<const CutFaces> faces_;
};

}  // namespace splatlas
