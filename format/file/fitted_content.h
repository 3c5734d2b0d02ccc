// Which surfaces and normals of a content a reader finds again from the voxels.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "format/atlas_content.h"
#include "format/derive/held_classes.h"

namespace splatlas {

/// Crops of more voxels than this are not fitted to when a file is read: such surfaces are stored.
inline constexpr std::uint64_t kMaxFittedVoxels = std::uint64_t{1} << 28;
/// Voxels of empty_crop_around(box), the larger one of the crops.
[[nodiscard]] std::uint64_t crop_voxels(const IndexBox& box);

struct FittedParts {
  std::vector<bool> surfaces;  ///< [structure]: its surface is exactly fit_surface()'s
  std::vector<bool> normals;   ///< [class]: its normals are exactly fit_normals()'s, from its normal_owner()
};

/// Fits everything again and compares, on `threads` threads. Cost: as of extracting all surfaces.
[[nodiscard]] FittedParts find_fitted_parts(const AtlasContent& content, unsigned threads,
                                            const std::function<void(double)>& progress = {});

/// Of each structure whether all of its voxels belong to the same structures: whoever reads a class that it
/// owns needs no more to find the normals of that. Cost: linear in the memberships.
[[nodiscard]] std::vector<bool> find_alike(const ClassTable& classes, const HeldClasses& held,
                                           std::size_t structures);

}  // namespace splatlas
