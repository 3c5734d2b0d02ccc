// Segmentation of additional structures by masks and thresholds, with ITK.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"

namespace splatlas {

/// Rule of one --segment option.
struct SegmentRule {
  enum class Kind { kMask, kThreshold, kOtsu, kIsosurface };
  std::string name;
  Kind kind = Kind::kThreshold;
  std::filesystem::path mask;  ///< kMask: file with non-zero voxels inside
  double low = 0;              ///< lower threshold or level of the isosurface, inclusive
  double high = std::numeric_limits<double>::infinity();  ///< kThreshold: upper threshold, inclusive
  double close_mm = 0;    ///< thresholds: radius of the morphological closing before holes are filled
  double open_mm = 0;     ///< kMask: radius of the morphological opening, after other structures are left out
  bool overlaps = false;  ///< kMask: also takes voxels of other structures
  std::string inside;     ///< kIsosurface: enclosing structure; empty for none
};

/// Parses NAME=mask:FILE[:open=MM][:overlap], NAME=threshold:LOW[:HIGH][:close=MM] with LOW a number or
/// "otsu", or NAME=iso:LEVEL[,inside=STRUCTURE]; kUsage otherwise.
[[nodiscard]] Result<SegmentRule> parse_segment(std::string_view text);

/// Segments by threshold (fixed, or Otsu 1979): the largest face-connected component, optionally closed, with
/// filled holes. Also fills holes that are open only at the border of the grid. Returns 1 inside, 0 outside;
/// NaN voxels are outside. `rule`: kThreshold or kOtsu. Uses all cores. kFailed if none is inside.
[[nodiscard]] Result<std::vector<std::uint8_t>> segment_volume(const VoxelBuffer& values, const Grid& grid,
                                                               const SegmentRule& rule);

/// 1 for finite values from `level` on, else 0.
[[nodiscard]] std::vector<std::uint8_t> voxels_from(const VoxelBuffer& values, double level);

/// Morphological opening of a mask by a ball of rule.open_mm. Beyond the grid counts as inside.
[[nodiscard]] Result<void> open_mask(std::vector<std::uint8_t>& mask, const Grid& grid,
                                     const SegmentRule& rule);

}  // namespace splatlas
