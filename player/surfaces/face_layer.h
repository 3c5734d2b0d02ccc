// Faces of a cut on the rays of a picture.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "format/structure_graph.h"

namespace splatlas {

/// A face on a ray.
struct Face {
  std::array<float, 4> rgba{0, 0, 0, 0};  ///< premultiplied, linear; alpha 0: no face
  float depth = 0;                        ///< as of fragments
  StructureIndex structure = kNoStructure;

  [[nodiscard]] bool shows() const { return rgba[3] > 0; }
};

/// The faces at both ends of the kept part of a ray. Everything else on the ray lies between them.
struct RayFaces {
  Face front, back;

  [[nodiscard]] bool show() const { return front.shows() || back.shows(); }
  /// Composites the radiance between the faces with them (Porter and Duff 1984).
  [[nodiscard]] std::array<float, 4> around(const std::array<float, 4>& rgba) const {
    std::array<float, 4> sum = front.rgba;
    const float behind_front = 1 - front.rgba[3], behind_all = behind_front * (1 - rgba[3]);
    for (std::size_t c = 0; c < 4; ++c) sum[c] += behind_front * rgba[c] + behind_all * back.rgba[c];
    return sum;
  }
};

/// Faces at the pixel centres of a picture, row by row. Keeps its memory from frame to frame.
struct FaceLayer {
  std::vector<Face> front, back;  ///< empty without faces

  [[nodiscard]] bool empty() const { return front.empty(); }
  [[nodiscard]] RayFaces at(std::size_t pixel) const { return {front[pixel], back[pixel]}; }
  /// Composites the faces of a pixel with the radiance between them (RGBA).
  void add_to(std::size_t pixel, float* rgba) const {
    const RayFaces faces = at(pixel);
    if (!faces.show()) return;
    std::array<float, 4> between;
    std::copy_n(rgba, 4, between.begin());
    std::ranges::copy(faces.around(between), rgba);
  }
  void clear() {
    front.clear();
    back.clear();
  }
};

}  // namespace splatlas
