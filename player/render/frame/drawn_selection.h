// Selection with its draw plan and the appearances of its classes.
#pragma once

#include <new>
#include <span>
#include <utility>
#include <vector>

#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "player/render/contributions/pixel_shares.h"
#include "player/render/decode/class_cache.h"
#include "player/render/surfaces/rasterize.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

/// Current selection of a renderer. Not thread-safe.
class DrawnSelection {
 public:
  explicit DrawnSelection(const Atlas& atlas) : appearances_(atlas) {}

  /// Replaces the selection; draw() must follow.
  void select(const Selection& selection) { selection_ = selection; }
  /// Replaces the draw plan and its appearances. Throws std::bad_alloc, and leaves an empty plan.
  void draw(DrawPlan plan) {
    plan_ = std::move(plan);
    try {
      numbers_.clear();
      for (const ClassDraw& of_class : plan_.classes) numbers_.push_back(number_of(of_class.volume_of));
      appearances_.select(plan_, selection_);
    } catch (const std::bad_alloc&) {
      clear();
      throw;
    }
  }
  /// Clears the draw plan and its appearances. Does not throw.
  void clear() {
    plan_ = {};
    appearances_.clear();
  }

  [[nodiscard]] const Selection& selection() const { return selection_; }
  [[nodiscard]] const DrawPlan& plan() const { return plan_; }
  [[nodiscard]] const VolumeAppearances& appearances() const { return appearances_; }
  /// Numbers of the structures of the plan's classes, for id images.
  [[nodiscard]] std::span<const StructureNumber> numbers() const { return numbers_; }
  [[nodiscard]] bool draws_nothing() const { return volume_classes(plan_).empty() && plan_.surfaces.empty(); }

  /// Surfaces of the plan with their appearances. `cache` must hold them at the level.
  [[nodiscard]] std::vector<SurfaceDraw> surfaces(const ClassCache& cache, int level) const {
    std::vector<SurfaceDraw> draws;
    for (const StructureIndex s : plan_.surfaces) {
      const ClassCache::DecodedSurface& of = cache.surface(s, level);
      draws.push_back(surface_draw(s, selection_.structures[s], of.mesh, of.clusters));
    }
    return draws;
  }

 private:
  Selection selection_;
  DrawPlan plan_;
  VolumeAppearances appearances_;         // of plan_.classes
  std::vector<StructureNumber> numbers_;  // the same
};

}  // namespace splatlas
