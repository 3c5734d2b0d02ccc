// Decoded classes and surfaces of a selection, and those that the file's damage makes unreadable.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "player/missing_parts.h"
#include "player/spans/class_cache.h"

namespace splatlas {

/// Decodes on demand and keeps what it has decoded.
class DecodedSelection {
 public:
  explicit DecodedSelection(std::shared_ptr<const Atlas> atlas) : atlas_(std::move(atlas)), cache_(atlas_) {}

  /// Reads and decodes the plan's classes along an axis and its surfaces, as far as they are not decoded yet.
  /// Where some cannot be read, returns the plan without them and lists them as missing. kLimit when memory
  /// runs out.
  [[nodiscard]] Result<std::optional<DrawPlan>> require(const DrawPlan& plan, Axis axis, bool normals,
                                                        ThreadPool& pool);
  /// Call when the selection changes: missing parts are tried again.
  void forget_missing() { missing_.clear(); }

  [[nodiscard]] const ClassCache& cache() const { return cache_; }
  [[nodiscard]] const std::vector<MissingPart>& missing() const { return missing_; }

 private:
  [[nodiscard]] Result<DrawPlan> without_damaged(const DrawPlan& plan);

  std::shared_ptr<const Atlas> atlas_;
  ClassCache cache_;
  std::vector<MissingPart> missing_;
};

}  // namespace splatlas
