// Faces of a cut on the rays of a picture.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/content/structure_graph.h"
#include "player/camera.h"
#include "player/render/decode/sparse_bytes.h"
#include "player/render/view/pixel_box.h"

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
  /// Columns [first, last) of a row.
  struct Extent {
    std::int32_t first = 0, last = 0;
  };

  PictureSize size{};
  SparseBytes of_front;       ///< faces by pixel: few are written, others are zeros; empty without faces
  SparseBytes of_back;        ///< faces by pixel; empty if no ray leaves the kept part
  std::vector<Extent> shown;  ///< of each row: pixels outside have no face

  [[nodiscard]] Face* front() const { return reinterpret_cast<Face*>(of_front.data()); }
  [[nodiscard]] Face* back() const { return reinterpret_cast<Face*>(of_back.data()); }
  [[nodiscard]] bool empty() const { return front() == nullptr; }
  [[nodiscard]] RayFaces at(std::size_t pixel) const {
    return {front()[pixel], back() == nullptr ? Face{} : back()[pixel]};
  }
  /// True if a face hides all else of a pixel.
  [[nodiscard]] bool hides(std::size_t pixel) const { return front()[pixel].rgba[3] >= 1; }
  /// The pixels of a region that may have a face, with one more on each side.
  [[nodiscard]] PixelBox around_faces(const PixelBox& region) const {
    PixelBox box{size.width, -1, size.height, -1};
    for (std::int32_t y = region.y_first; y <= region.y_last; ++y) {
      const auto [first, last] = shown[static_cast<std::size_t>(y)];
      if (first >= last) continue;
      box = {std::min(box.x_first, first), std::max(box.x_last, last - 1), std::min(box.y_first, y), y};
    }
    return box.empty() ? box : intersection(region, box.grown(1));
  }
  /// Composites the faces of columns [begin, end) of a row with the radiance between them (RGBA, whole row).
  void add_to_row(std::size_t row, std::int32_t begin, std::int32_t end, float* rgba) const {
    const std::size_t first = row * static_cast<std::size_t>(size.width);
    const auto [shown_first, shown_last] = shown[row];
    for (std::int32_t column = std::max(begin, shown_first); column < std::min(end, shown_last); ++column) {
      const RayFaces faces = at(first + static_cast<std::size_t>(column));
      if (!faces.show()) continue;
      float* const pixel = rgba + std::ptrdiff_t{4} * column;
      std::array<float, 4> between;
      std::copy_n(pixel, 4, between.begin());
      std::ranges::copy(faces.around(between), pixel);
    }
  }
};

}  // namespace splatlas
