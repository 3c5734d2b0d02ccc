#include "player/render/frame/decoded_selection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "format/result_macros.h"
#include "player/render/frame/frame_renderer.h"
#include "player/render/light/voxel_light.h"

namespace splatlas {

bool DecodedSelection::begin(const DrawPlan& plan, std::uint64_t bytes) {
  missing_.clear();
  cache_.begin(plan.surfaces, std::uint64_t{64} << 20);
  if (cache_.bytes() <= bytes) return false;
  cache_ = ClassCache(atlas_);
  return true;
}

int DecodedSelection::surface_level(const DrawPlan& plan, double voxel_pixels, const RenderOptions& options,
                                    const ThreadPool& pool) {
  // Times to derive surfaces, for each triangle of level 0, on one thread
  constexpr double kFineMs = 300e-6, kCoarseMs = 400e-6;
  constexpr double kMaxWaitMs = 500;
  if (!may_be_rough(options)) return 0;
  return pace_.next(voxel_pixels, [&](int level) {
    double missing = 0;
    for (const StructureIndex s : plan.surfaces) {
      if (!cache_.has_surface(s, level) && atlas_->has_levels(s))
        missing += static_cast<double>(atlas_->triangles(s));
    }
    const double ms = missing * (level == 0 ? kFineMs : std::ldexp(kCoarseMs, -2 * level)) / pool.threads();
    return ms <= (level == 0 ? 2 * options.draft_budget_ms : kMaxWaitMs);
  });
}

int DecodedSelection::quick_level(const DrawPlan& plan) const {
  constexpr double kMaxTriangles = 4e5;
  double triangles = 0;
  for (const StructureIndex s : plan.surfaces) {
    if (atlas_->has_levels(s)) triangles += static_cast<double>(atlas_->triangles(s));
  }
  int level = 0;
  while (level < Coverage::kMaxLevel &&
         std::ldexp(triangles, -2 * level) > (level == 0 ? 1 : 6) * kMaxTriangles)
    ++level;
  return level;
}

bool DecodedSelection::waits_for_values(const DrawPlan& plan, double voxel_pixels,
                                        const RenderOptions& options, const ThreadPool& pool) const {
  constexpr double kMsPerVoxel = 100e-6;  // to decode values and normals, on one thread
  constexpr double kMaxWaitMs = 500, kMaxPixels = 32;
  if (!may_be_rough(options) || !options.cuts.empty() || options.classification == Classification::kAfter ||
      std::ldexp(voxel_pixels, kMeanLevel) > kMaxPixels)
    return false;
  double missing = 0;
  for (const ClassId c : volume_classes(plan)) {
    if (atlas_->has_means(c) && !cache_.has_values(c))
      missing += static_cast<double>(atlas_->classes().voxels(c));
  }
  return missing * kMsPerVoxel / pool.threads() > kMaxWaitMs;
}

void DecodedSelection::took(const RenderStats& stats, const RenderOptions& options) {
  if (!may_be_rough(options) || stats.triangles == 0) return;
  pace_.took(stats.rasterize.wall_ms, options.draft_budget_ms / (stats.voxels_visited > 0 ? 2 : 1));
}

Result<std::optional<DrawPlan>> DecodedSelection::require(const DrawPlan& plan, Axis axis, VoxelParts parts,
                                                          int surface_level, ThreadPool& pool) {
  const std::vector<ClassId> of_volume =
      parts == VoxelParts::kNone ? std::vector<ClassId>() : volume_classes(plan);
  for (const ClassDraw& draw : plan.classes) {
    if (draw.boundary && parts == VoxelParts::kNormals) cache_.forget_lost_normals(draw.id, draw.volume_of);
  }
  const Result<void> classes = cache_.require(of_volume, axis, pool, parts);
  if (!classes && cache_.failed_classes().empty()) return tl::unexpected(classes.error());
  const Result<void> surfaces = cache_.require_surfaces(plan.surfaces, pool, surface_level);
  if (classes && surfaces) return std::nullopt;

  // Out of memory is no damage
  const auto check = [](const auto& failed) -> Result<void> {
    for (const auto& of : failed) {
      if (of.error.code == ErrorCode::kLimit) return tl::unexpected(of.error);
    }
    return {};
  };
  SPLATLAS_RETURN_IF_ERROR(check(cache_.failed_classes()));
  SPLATLAS_RETURN_IF_ERROR(check(cache_.failed_surfaces()));

  // List the damaged parts, and remove them from the plan
  DrawPlan rest = plan;
  for (MissingPart& part :
       leave_out(cache_.failed_classes(), cache_.failed_surfaces(), atlas_->classes(), rest)) {
    list_missing(std::move(part));
  }
  return rest;
}

void DecodedSelection::light(const DrawPlan& plan, const VolumeAppearances& appearances, ThreadPool& pool) {
  light_voxels(plan, appearances, atlas_->classes(), atlas_->grid(), cache_, pool);
}

void DecodedSelection::list_missing(MissingPart part) {
  const auto known = std::ranges::find_if(missing_, [&](const MissingPart& other) {
    return other.structure == part.structure && other.surface == part.surface;
  });
  if (known == missing_.end()) {
    missing_.push_back(std::move(part));
  } else {
    known->voxels += part.voxels;
  }
}

Result<void> DecodedSelection::require_faces(std::span<const FaceClass> faces, Axis axis, ThreadPool& pool) {
  std::vector<ClassId> classes;
  for (ClassId c = 0; c < faces.size(); ++c) {
    if (faces[c].has_face()) classes.push_back(c);
  }
  Result<void> required = cache_.require(classes, axis, pool, VoxelParts::kValues);
  if (required) return {};
  if (cache_.failed_classes().empty()) return required;
  for (const FailedClass& of : cache_.failed_classes()) {
    if (of.error.code == ErrorCode::kLimit) return tl::unexpected(of.error);
  }
  for (const FailedClass& of : cache_.failed_classes())
    list_missing({faces[of.id].structure, false, atlas_->classes().voxels(of.id), of.error});
  return {};
}

Result<void> FaceStore::require(const RenderOptions& options, Axis axis, const Atlas& atlas,
                                const DrawnSelection& drawn, DecodedSelection& decoded, ThreadPool& pool) {
  if (!shows_faces(options)) {
    clear();
    return {};
  }
  if (faces_ && faces_->planes() == options.cuts) return {};
  const auto classes = std::make_shared<const std::vector<FaceClass>>(
      face_classes(atlas.classes(), drawn.selection(), drawn.plan()));
  SPLATLAS_RETURN_IF_ERROR(decoded.require_faces(*classes, axis, pool));
  const FaceScene scene{.atlas = atlas,
                        .selection = drawn.selection(),
                        .plan = drawn.plan(),
                        .classes = classes,
                        .cache = decoded.cache(),
                        .axis = axis,
                        .appearances = drawn.appearances().appearances()};
  SPLATLAS_ASSIGN_OR_RETURN(CutFaces built, CutFaces::build(options.cuts, scene, faces_.get(), pool));
  faces_ = std::make_shared<const CutFaces>(std::move(built));
  return {};
}

}  // namespace splatlas
