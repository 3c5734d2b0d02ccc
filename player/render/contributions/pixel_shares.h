// Shares of structures in a pixel's opacity.
#pragma once

#include <vector>

#include "player/picture.h"
#include "player/render/clip/face_layer.h"

namespace splatlas {

/// Number of a structure in an id image; 0 for kNoStructure.
[[nodiscard]] inline StructureNumber number_of(StructureIndex structure) {
  return structure == kNoStructure ? StructureNumber{0} : static_cast<StructureNumber>(structure + 1);
}

/// Opacity below which a pixel of an id image has no structure.
inline constexpr float kMinIdOpacity = 1.0f / 255;

/// Sums of contributions to a pixel by structure. Keeps its memory.
class PixelShares {
 public:
  void clear() { sums_.clear(); }
  void add(StructureNumber number, float share) {
    for (Sum& sum : sums_) {
      if (sum.number != number) continue;
      sum.share += share;
      return;
    }
    sums_.push_back({number, share});
  }
  /// Adds other shares with a weight.
  void add(const PixelShares& other, float weight) {
    for (const Sum& sum : other.sums_) add(sum.number, weight * sum.share);
  }
  /// Adds the faces of a cut and the shares between them, with a weight.
  void add_between(const RayFaces& faces, const PixelShares& between, float weight) {
    const float behind_front = weight * (1 - faces.front.rgba[3]);
    if (faces.front.shows()) add(number_of(faces.front.structure), weight * faces.front.rgba[3]);
    add(between, behind_front);
    if (faces.back.shows())
      add(number_of(faces.back.structure), behind_front * (1 - between.total()) * faces.back.rgba[3]);
  }
  [[nodiscard]] float total() const {
    float total = 0;
    for (const Sum& sum : sums_) total += sum.share;
    return total;
  }
  /// The structure with the largest share, of equal ones the lowest number; 0 without shares.
  [[nodiscard]] StructureNumber largest() const {
    Sum best;
    for (const Sum& sum : sums_) {
      if (sum.share > best.share || (sum.share == best.share && sum.number < best.number)) best = sum;
    }
    return best.number;
  }

 private:
  struct Sum {
    StructureNumber number = 0;
    float share = 0;
  };
  std::vector<Sum> sums_;
};

}  // namespace splatlas
