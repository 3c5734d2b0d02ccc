#include "player/web/server/call_answer.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "player/render/view/pixel_box.h"

namespace splatlas {
namespace {

/// The smallest box with all pixels that are not transparent; that of one pixel if there are none.
PixelBox seen_pixels(const Picture& picture) {
  const auto [width, height] = picture.size;
  PixelBox box{width, -1, height, -1};
  for (std::int32_t y = 0; y < height; ++y) {
    const float* const row = &picture.rgba[4 * picture.size.pixel(0, y)];
    std::int32_t first = 0, last = width - 1;
    while (first <= last && !(row[4 * first + 3] > 0)) ++first;
    while (first < last && !(row[4 * last + 3] > 0)) --last;
    if (first > last) continue;
    box = {std::min(box.x_first, first), std::max(box.x_last, last), std::min(box.y_first, y), y};
  }
  return box.empty() ? PixelBox{0, 0, 0, 0} : box;
}

}  // namespace

std::string call_answer(const PageAnswer& answer, const Picture& picture) {
  const PixelBox box = answer.has_picture ? seen_pixels(picture) : PixelBox{};
  const std::array<std::int32_t, 6> numbers{answer.status, static_cast<std::int32_t>(answer.text.size()),
                                            box.x_first,   box.y_first,
                                            box.width(),   box.height()};
  std::string bytes(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
  std::size_t end = bytes.size() + answer.text.size();
  bytes += answer.text;
  bytes.resize(end + 4 * box.pixels());
  const std::size_t row = 4UL * static_cast<std::size_t>(box.width());
  for (std::int32_t y = box.y_first; y <= box.y_last; ++y, end += row)
    to_srgba8(std::span(picture.rgba).subspan(4 * picture.size.pixel(box.x_first, y), row),
              reinterpret_cast<std::uint8_t*>(&bytes[end]));
  return bytes;
}

}  // namespace splatlas
