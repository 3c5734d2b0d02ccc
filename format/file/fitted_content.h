// Check of content ahead of writing, and the surfaces and normals that readers can derive from the voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/derive/structure_crop.h"
#include "format/result.h"

namespace splatlas {

/// Maximum size of a crop for fitting on reading; surfaces of larger structures are stored.
inline constexpr std::uint64_t kMaxFittedVoxels = std::uint64_t{1} << 28;
/// Number of voxels of crop_around(box), the larger of the two crops.
[[nodiscard]] std::uint64_t crop_voxels(const IndexBox& box);

/// Bytes that fit_surface() or fit_normals() hold: the crop, and 23 floats per voxel of a slice.
[[nodiscard]] inline double crop_bytes(const IndexBox& box) {
  const auto voxels = static_cast<double>(crop_voxels(box));
  return voxels + 92 * voxels / static_cast<double>(box.last[2] - box.first[2] + 1);
}

/// True if a reader fits faster from runs than from a crop of the bounding box. `items` are vertices of a
/// surface or voxels with normals; one costs about as much as 200 voxels of a crop.
[[nodiscard]] inline bool fits_sparsely(const IndexBox& box, std::uint64_t items) {
  return crop_voxels(box) / 200 > items;
}

/// Surfaces and normals that need not be stored.
struct FittedParts {
  std::vector<FittedSurface> surfaces;  ///< [structure]: with triangles if it equals fit_surface()
  std::vector<bool> normals;            ///< [class]: its normals equal fit_normals() of its normal_owner()
};

/// Fits the surfaces and normals that AtlasContent::fitted does not name and compares, on `threads` threads
/// (0: one per core). `runs` are those of the class volume along z. Cost: that of extracting all surfaces.
[[nodiscard]] FittedParts find_fitted_parts(const AtlasContent& content, const RunModel& runs,
                                            unsigned threads);

/// [structure]: true if all its voxels belong to the same set of structures. Fitting the normals of such a
/// class needs no voxels of other groups. Cost: linear in the memberships.
[[nodiscard]] std::vector<bool> find_uniform(const ClassTable& classes,
                                             const StructureClasses& structure_classes,
                                             std::size_t structures);

/// kFailed if sizes, class ids, counts, boxes or the order of classes of the content are inconsistent.
/// validate() checks its directory, and encode_surface() its surfaces. Cost: one pass over the class volume.
[[nodiscard]] Result<void> check_content(const AtlasContent& content);

}  // namespace splatlas
