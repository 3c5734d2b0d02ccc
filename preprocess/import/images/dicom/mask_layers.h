// Layers of structures that may overlap.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

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
