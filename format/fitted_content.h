// Which surfaces and normals of a content a reader finds again from the voxels.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "format/atlas_content.h"

namespace splatlas {

/// Crops of more voxels than this are not fitted to when a file is read: such surfaces are stored.
inline constexpr std::uint64_t kMaxFittedVoxels = std::uint64_t{1} << 28;
/// Voxels of empty_crop_around(box), the larger one of the crops.
[[nodiscard]] std::uint64_t crop_voxels(const IndexBox& box);

/// The box around the voxels that a structure holds.
[[nodiscard]] IndexBox box_of(const ClassTable& classes, StructureIndex structure);

struct FittedParts {
  std::vector<bool> surfaces;  ///< [structure]: its surface is exactly fit_surface()'s
  std::vector<bool> normals;   ///< [class]: its normals are exactly fit_normals()'s, from its normal_owner()
};

/// Fits everything again and compares, on `threads` threads. Cost: as of extracting all surfaces.
[[nodiscard]] FittedParts find_fitted_parts(const AtlasContent& content, unsigned threads,
                                            const std::function<void(double)>& progress = {});

/// Whether all voxels of the class's normal owner belong to the same structures as the class's: whoever reads
/// the class needs no more to find its normals.
[[nodiscard]] bool owner_is_alike(const ClassTable& classes, ClassId c);

}  // namespace splatlas
