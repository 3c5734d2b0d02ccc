// Faces of the latest cut of a renderer's selection.
#pragma once

#include <memory>

#include "player/render/clip/cut_faces.h"
#include "player/render/frame/decoded_selection.h"
#include "player/render/frame/drawn_selection.h"

namespace splatlas {

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
