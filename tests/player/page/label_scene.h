// Random pictures of discs, with a fixed-width font.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <string_view>

#include "player/page/annotate_picture.h"

namespace splatlas {

/// Every byte is half an em wide.
inline double fixed_width(std::string_view text, double size, FontStyle /*style*/) {
  return 0.5 * size * static_cast<double>(text.size());
}

/// Discs in a picture: later ones lie over earlier ones.
struct DiscScene {
  Picture picture;
  IdGrid grid;

  explicit DiscScene(PictureSize size)
      : picture{size, std::vector<float>(4 * static_cast<std::size_t>(size.width) *
                                         static_cast<std::size_t>(size.height))},
        grid{size.width, size.height, 1, std::vector<StructureIndex>(picture.rgba.size() / 4, kNoStructure)} {
  }

  void add(StructureIndex id, double x, double y, double radius) {
    const auto first = [radius](double at) { return std::max(0, static_cast<int>(at - radius)); };
    for (int j = first(y); j < std::min<double>(picture.size.height, y + radius); ++j) {
      for (int i = first(x); i < std::min<double>(picture.size.width, x + radius); ++i) {
        if (std::hypot(i + 0.5 - x, j + 0.5 - y) > radius) continue;
        const std::size_t n = picture.size.pixel(i, j);
        grid.ids[n] = id;
        std::fill_n(picture.rgba.begin() + static_cast<std::ptrdiff_t>(4 * n), 4, 1.0f);
      }
    }
  }

  [[nodiscard]] AnnotatedScene annotated() const {
    View view;
    view.plane.right_lps = {1, 0, 0}, view.plane.up_lps = {0, 0, 1}, view.plane.forward_lps = {0, 1, 0};
    view.plane.mm_per_pixel = 0.25;
    view.plane.size = picture.size;
    AnnotatedScene scene{picture, view, Rgb{0, 0, 0}};
    for (const VisibleStructure& one : visible_structures(grid)) {
      scene.structures.push_back(
          {"Structure number " + std::to_string(one.structure), Rgb{200, 100, 50}, one});
    }
    return scene;
  }
};

inline DiscScene random_discs(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto within = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random()) / 4294967296.0;
  };
  const PictureSize size{static_cast<int>(within(500, 900)), static_cast<int>(within(400, 800))};
  DiscScene scene(size);
  const double side = std::min(size.width, size.height), spread = within(0.1, 0.6);
  const int discs = static_cast<int>(within(1, 45));
  for (int n = 0; n < discs; ++n) {
    scene.add(static_cast<StructureIndex>(n), size.width * (0.5 + spread * within(-0.5, 0.5)),
              size.height * (0.5 + spread * within(-0.5, 0.5)), side * within(0.01, 0.12));
  }
  return scene;
}

}  // namespace splatlas
