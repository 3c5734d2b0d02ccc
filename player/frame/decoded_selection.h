// Decoded and missing classes and surfaces of a selection.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "player/missing_parts.h"
#include "player/spans/class_cache.h"

namespace splatlas {

/// Decodes classes and surfaces on demand, and caches them. Not thread-safe.
class DecodedSelection {
 public:
  explicit DecodedSelection(std::shared_ptr<const Atlas> atlas) : atlas_(std::move(atlas)), cache_(atlas_) {}

  /// Reads and decodes the uncached classes along `axis` and surfaces of a plan; `normals`: also the normals
  /// of boundary voxels. Lists damaged parts in missing(), and returns the plan without them; none if all
  /// parts are intact. kLimit when out of memory.
  [[nodiscard]] Result<std::optional<DrawPlan>> require(const DrawPlan& plan, Axis axis, bool normals,
                                                        ThreadPool& pool);
  /// Clears missing(), so that require() tries these parts again. For a new selection.
  void forget_missing() { missing_.clear(); }

  [[nodiscard]] const ClassCache& cache() const { return cache_; }
  [[nodiscard]] const std::vector<MissingPart>& missing() const { return missing_; }

 private:
  std::shared_ptr<const Atlas> atlas_;
  ClassCache cache_;
  std::vector<MissingPart> missing_;
};

}  // namespace splatlas
