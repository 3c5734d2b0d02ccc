#include "player/page/free_space.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace splatlas {
namespace {

constexpr int kCellsOnShortSide = 1024;
constexpr float kVisibleAlpha = 1.0f / 512;

}  // namespace

FreeSpace::FreeSpace(const PictureSize& size)
    : cell_(std::max(1, std::min(size.width, size.height) / kCellsOnShortSide)),
      columns_((size.width + cell_ - 1) / cell_),
      rows_((size.height + cell_ - 1) / cell_),
      sums_(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1)) {}

FreeSpace::FreeSpace(const Picture& picture) : FreeSpace(picture.size) {
  // Mark the cells that show structures
  const auto at = [this](int column, int row) -> std::uint32_t& {
    return sums_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_ + 1) +
                 static_cast<std::size_t>(column)];
  };
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      if (picture.at(x, y)[3] > kVisibleAlpha) at(x / cell_ + 1, y / cell_ + 1) = 1;
    }
  }

  // Sum them up, and find their bounding box
  const double side = cell_;
  for (int row = 1; row <= rows_; ++row) {
    for (int column = 1; column <= columns_; ++column) {
      if (at(column, row) != 0) {
        const PageBox cell{side * (column - 1), side * (row - 1), side * column, side * row};
        if (!content_) content_ = cell;
        *content_ = {std::min(content_->left, cell.left), std::min(content_->top, cell.top),
                     std::max(content_->right, cell.right), std::max(content_->bottom, cell.bottom)};
      }
      at(column, row) += at(column - 1, row) + at(column, row - 1) - at(column - 1, row - 1);
    }
  }
}

std::uint32_t FreeSpace::sum(int column, int row) const {
  return sums_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_ + 1) +
               static_cast<std::size_t>(column)];
}

bool FreeSpace::is_free(const PageBox& box) const {
  const auto cells = [this](double position, int count, bool up) {
    const double n = position / cell_;
    return static_cast<int>(std::clamp(up ? std::ceil(n) : std::floor(n), 0.0, static_cast<double>(count)));
  };
  const int left = cells(box.left, columns_, false), right = cells(box.right, columns_, true);
  const int top = cells(box.top, rows_, false), bottom = cells(box.bottom, rows_, true);
  if (left >= right || top >= bottom) return true;
  return sum(right, bottom) + sum(left, top) == sum(left, bottom) + sum(right, top);
}

}  // namespace splatlas
