// Slices through the voxels of an atlas, for a page.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "format/atlas_reader.h"

namespace splatlas {

/// Structures and grey values of the slices of an atlas across the axes of its storage grid. Decodes the
/// classes that a slice meets, and keeps them: 16 bytes a run, and the grey values. Not thread-safe.
class PageSlices {
 public:
  explicit PageSlices(std::shared_ptr<const Atlas> atlas) : atlas_(std::move(atlas)) {}

  /// A slice, row by row along the first of the other axes: {labels: [number, count, ...], the runs of 1 + a
  /// structure's index, 0 for none, and greys: two hexadecimal digits a voxel, from 0 to 255 in the display
  /// window}. Damaged classes are left out. kNotFound for no such slice, kLimit for more than 2^24 voxels.
  /// Cost: linear in the runs of these classes.
  [[nodiscard]] Result<nlohmann::ordered_json> slice(int axis, std::int64_t index);

 private:
  struct Decoded {
    ClassRuns runs;
    std::vector<std::byte> values;
  };
  struct Pixels {
    std::vector<std::uint16_t> labels;
    std::vector<std::uint8_t> greys;
  };
  [[nodiscard]] Result<void> decode(ClassId c);
  void paint(ClassId c, std::size_t axis, std::int64_t index, Pixels& pixels) const;

  std::shared_ptr<const Atlas> atlas_;
  std::map<ClassId, Decoded> classes_;
};

}  // namespace splatlas
