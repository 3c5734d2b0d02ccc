// DICOM segmentations (masks, fractions and label maps), contours (RTSTRUCT), and the layers that they fill.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/content/color.h"
#include "format/result.h"
#include "preprocess/import/images/dicom/dicom_frame.h"
#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// The structures and voxels of a segmentation: uint8, or uint16 for segment numbers above 255. BINARY
/// segments are masks; FRACTIONAL ones are masks of the voxels above one half of the maximum; a LABELMAP
/// holds segment numbers, and its padding value is background. A segment that overlaps others goes to the
/// first layer in which it overlaps none. Slices without a frame are empty. Structures have the segment's
/// label, colour and codes: {"SNOMED", "23451007"}, {"modifier SNOMED", "7771000"}. A label that cannot be a
/// name becomes "segment N", with a note. kFailed for damaged files, unknown kinds, and segment numbers that
/// repeat or are not listed. Cost: frames are decoded once; memory of layers and a segment. One at a time.
[[nodiscard]] Result<SourceImage> read_segmentation(SlicedStack stack, const std::filesystem::path& path);

/// A segment of a file; "segment 7", with a note, if its label cannot be a name.
[[nodiscard]] SourceSegment named_segment(std::string label, std::int64_t number, Notes& notes);

/// sRGB colour of a RecommendedDisplayCIELabValue, for the white point D65 that writers of segmentations use.
/// Colours outside sRGB are clamped.
[[nodiscard]] Rgb color_of_lab(const std::array<double, 3>& encoded);

/// Fills the closed contours of each structure: voxels whose centres are within, by the even-odd rule, so
/// that a contour within another is a hole. A slice takes the nearest plane of contours, and none where
/// planes are missing. Structures have the file's names and colours, and may overlap. Warnings tell
/// of points and open lines, which enclose nothing, and of structures that `grid` cuts off. kFailed without a
/// grid, for damaged files, and for contours across slices. Cost: memory for the layers and the largest
/// structure. One thread at a time.
[[nodiscard]] Result<SourceImage> read_contours(const std::filesystem::path& path,
                                                const std::optional<Grid>& grid);

/// The voxels of one structure in one slice.
struct SliceMask {
  std::size_t slice = 0;
  std::vector<bool> voxels;
};

/// Layers of numbers of type T, uint8 or uint16.
template <typename T>
class MaskLayers {
  using Layer = std::vector<T>;

 public:
  explicit MaskLayers(const Grid& grid)
      : plane_(static_cast<std::size_t>(grid.size[0] * grid.size[1])),
        layers_(1, Layer(static_cast<std::size_t>(grid.voxels()))) {}

  /// Voxels of a slice.
  [[nodiscard]] std::size_t plane() const { return plane_; }

  /// Writes a structure to the first layer in which it overlaps none, whose index it returns.
  std::size_t add(const std::vector<SliceMask>& masks, T number) {
    std::size_t layer = 0;
    while (layer < layers_.size() && overlaps(masks, layers_[layer])) ++layer;
    if (layer == layers_.size()) layers_.emplace_back(layers_.front().size());
    for (const SliceMask& mask : masks) {
      for (std::size_t v = 0; v < plane_; ++v) {
        if (mask.voxels[v]) layers_[layer][mask.slice * plane_ + v] = number;
      }
    }
    return layer;
  }

  [[nodiscard]] Layer& first() { return layers_.front(); }

  void hand_over(SourceImage& image) const {
    image.layers = layers_.size();
    image.voxels.type = sizeof(T) == 1 ? VoxelType::kUInt8 : VoxelType::kUInt16;
    const std::size_t bytes = layers_[0].size() * sizeof(T);
    image.voxels.bytes.resize(bytes * layers_.size());
    for (std::size_t n = 0; n < layers_.size(); ++n)
      std::memcpy(&image.voxels.bytes[n * bytes], layers_[n].data(), bytes);
  }

 private:
  bool overlaps(const std::vector<SliceMask>& masks, const Layer& layer) const {
    return std::ranges::any_of(masks, [&](const SliceMask& mask) {
      const T* const voxels = &layer[mask.slice * plane_];
      for (std::size_t v = 0; v < plane_; ++v) {
        if (mask.voxels[v] && voxels[v] != 0) return true;
      }
      return false;
    });
  }

  std::size_t plane_;
  std::vector<Layer> layers_;
};

}  // namespace splatlas
