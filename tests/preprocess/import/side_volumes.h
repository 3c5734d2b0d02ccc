// Labelled volumes of known sides, and files of them, byte by byte, without the product's geometry.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "format/content/grid.h"

namespace splatlas {

/// A body with three marks: 1 at its left side, 2 at its front, 3 at its top. Body indices grow to the left,
/// to posterior and upwards, along unit vectors in LPS, which may be oblique.
struct Body {
  Index3 size{8, 6, 5};
  Vec3 spacing_mm{0.75, 1.5, 3.25};
  Vec3 origin_lps_mm{-12.5, 33.25, 7};
  std::array<Vec3, 3> axes_lps{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

  [[nodiscard]] Vec3 position(const Index3& index) const;
  /// The mark of a voxel; 0 for none.
  [[nodiscard]] std::uint8_t mark(const Index3& index) const;
  /// Mean of the positions of the voxels of a mark, LPS mm.
  [[nodiscard]] Vec3 centroid(std::uint8_t mark) const;
};

/// The axes of a body turned around all three axes of the patient.
[[nodiscard]] std::array<Vec3, 3> oblique_axes();

/// Voxels of a body in the order of a file.
struct PlacedVolume {
  Index3 size;
  Vec3 first_lps_mm;                 ///< centre of the first voxel
  Vec3 spacing_mm;                   ///< along the axes of the file
  std::array<Vec3, 3> axes_lps;      ///< unit vectors
  std::vector<std::uint8_t> values;  ///< marks, first axis fastest
};

/// File axis a is body axis `order.from[a]`, reversed if `order.flipped[a]`.
[[nodiscard]] PlacedVolume placed(const Body& body, const AxisOrder& order);

// Files, as their specifications say.
[[nodiscard]] std::string nifti_by_sform(const PlacedVolume& volume);
[[nodiscard]] std::string nifti_by_qform(const PlacedVolume& volume);
[[nodiscard]] std::string nifti2_by_sform(const PlacedVolume& volume);
/// `space`: the three letters of left or right, posterior or anterior, and superior.
[[nodiscard]] std::string nrrd_in(const PlacedVolume& volume, const std::string& space);
/// The same in LPS with the segments "left", "front" and "top" of 3D Slicer.
[[nodiscard]] std::string seg_nrrd(const PlacedVolume& volume);
[[nodiscard]] std::string meta_image_of(const PlacedVolume& volume);
[[nodiscard]] std::string mgh_of(const PlacedVolume& volume);

}  // namespace splatlas
