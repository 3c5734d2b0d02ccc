// Structures that no label map gives: segmented with ITK.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/grid.h"
#include "format/voxel_type.h"

namespace splatlas {

/// One --segment: a structure and where its voxels come from.
struct SegmentRule {
  enum class Kind { kMask, kThreshold, kOtsu };
  std::string name;
  Kind kind = Kind::kThreshold;
  std::filesystem::path mask;                             ///< kMask: what is not 0 in this file
  double low = 0;                                         ///< kThreshold: grey values from low ...
  double high = std::numeric_limits<double>::infinity();  ///< ... to high, both included
  double close_mm = 0;  ///< thresholds: gaps up to twice this wide are closed before holes are filled
};

/// Reads NAME=mask:FILE or NAME=threshold:LOW[:HIGH][:close=MM], LOW a number or "otsu"; kUsage tells what is
/// wrong.
[[nodiscard]] Result<SegmentRule> parse_segment(std::string_view text);

/// Voxels within the rule's thresholds (Otsu's finds its own), of these the largest connected piece (faces
/// connect), with its holes filled, those too that only the end of the grid cuts open: 1 inside, 0 outside.
/// `rule` must not be kMask. Voxels whose value is not a number are outside. ITK does it on all cores.
/// kFailed when nothing is within the thresholds.
[[nodiscard]] Result<std::vector<std::uint8_t>> segment_volume(const VoxelBuffer& values, const Grid& grid,
                                                               const SegmentRule& rule);

}  // namespace splatlas
