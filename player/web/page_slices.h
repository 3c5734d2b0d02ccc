// Slices through the voxels of an atlas, for a page.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "format/atlas_reader.h"

namespace splatlas {

/// Structures and grey values of the slices of an atlas across the axes of its storage grid. Decodes the
/// classes that a slice meets, and keeps them: three bytes a voxel of the grid. Not thread-safe.
class PageSlices {
 public:
  explicit PageSlices(std::shared_ptr<const Atlas> atlas);

  /// A slice, row by row along the first of the other axes: {labels: [number, count, ...], the runs of 1 + a
  /// structure's index, 0 for none, and greys: two hexadecimal digits a voxel, from 0 to 255 in the display
  /// window}. kNotFound for no such slice.
  [[nodiscard]] Result<nlohmann::ordered_json> slice(int axis, std::int64_t index);

 private:
  [[nodiscard]] Result<void> decode(ClassId c);

  std::shared_ptr<const Atlas> atlas_;
  std::vector<bool> decoded_;  // [class]
  std::vector<std::uint16_t> labels_;
  std::vector<std::uint8_t> greys_;
};

}  // namespace splatlas
