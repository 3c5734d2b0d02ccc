// Segmentation of additional structures by masks, thresholds and morphology, with ITK.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/color.h"
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
  double open_mm =
      0;  ///< radius of the opening: of a mask after other structures are left out, else before pieces
  double close_mm = 0;                   ///< thresholds: radius of the closing before holes are filled
  std::size_t pieces = 1;                ///< thresholds: the largest ones stay
  bool inner = false;                    ///< thresholds: without pieces at the border of the slices
  std::optional<Vec3> seed_lps_mm = {};  ///< thresholds: the piece at this point stays alone
  bool fills = true;                     ///< thresholds: fills holes
  bool overlaps = false;                 ///< also takes voxels of other structures
  std::string within;                    ///< enclosing structure; empty for none
  std::optional<Rgb> color = {};
};

/// Parses NAME=mask:FILE, NAME=threshold:LOW[:HIGH] with LOW a number or "otsu", or NAME=iso:LEVEL, with
/// options behind: ":open=MM", ":close=MM", ":pieces=N", ":inner", ":seed=X,Y,Z", ":within=NAME", ":fill=no",
/// ":overlap" and
/// ":color=#rrggbb". kUsage otherwise.
[[nodiscard]] Result<SegmentRule> parse_segment(std::string_view text);

/// 1 for values within the thresholds of a rule (fixed, or Otsu 1979), else 0, as for NaN.
[[nodiscard]] std::vector<std::uint8_t> voxels_between(const VoxelBuffer& values, const SegmentRule& rule);

/// Refines the voxels of a mask, which it opens, or within thresholds: opens them, keeps the face-connected
/// pieces of the rule, closes them and fills holes, also those that are open only at the border of the grid.
/// Uses all cores. kFailed if none is left.
[[nodiscard]] Result<void> refine_segment(std::vector<std::uint8_t>& mask, const Grid& grid,
                                          const SegmentRule& rule);

/// 1 for finite values from `level` on, else 0.
[[nodiscard]] std::vector<std::uint8_t> voxels_from(const VoxelBuffer& values, double level);

/// Opening or closing of a mask (0 or 1, i fastest) of `size` by the ellipsoid of these radii in voxels,
/// which has the voxels of ITK's BinaryBallStructuringElement. Cost: a few instructions for 64 voxels and
/// each row of the ellipsoid. Memory: 1 bit per voxel, two times. Uses all cores. Closing: beyond the grid
/// counts as outside, and a structure can reach there.
void close_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii);
/// Opening: beyond the grid counts as inside.
void open_mask(std::vector<std::uint8_t>& mask, const Index3& size, const Index3& radii);

}  // namespace splatlas
