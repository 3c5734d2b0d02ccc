// Pixels of a picture without structures: emptiness test for any box.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "player/page/annotation.h"
#include "player/picture.h"

namespace splatlas {

/// Summed-area table (Crow 1984) of the cells of a picture that show structures: O(1) for any box. Cells have
/// a few pixels, so a box counts as covered up to one cell before it touches a structure.
class FreeSpace {
 public:
  /// Of a picture without structures. O(cells).
  explicit FreeSpace(const PictureSize& size);
  /// Pixels above an alpha of 1/512 show structures: they may change an 8-bit picture. O(pixels).
  explicit FreeSpace(const Picture& picture);

  /// True if no pixel of the box shows a structure. Only the part inside the picture counts.
  [[nodiscard]] bool is_free(const PageBox& box) const;
  /// Bounding box of all structures; none for an empty picture.
  [[nodiscard]] std::optional<PageBox> content() const { return content_; }

 private:
  [[nodiscard]] std::uint32_t sum(int column, int row) const;

  int cell_, columns_, rows_;
  std::vector<std::uint32_t> sums_;
  std::optional<PageBox> content_;
};

}  // namespace splatlas
