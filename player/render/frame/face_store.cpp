#include "player/render/frame/face_store.h"

#include <utility>
#include <vector>

#include "format/result_macros.h"
#include "player/render/frame/frame_renderer.h"

namespace splatlas {

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
