// What POST /call returns.
#pragma once

#include <string>

#include "player/picture.h"
#include "player/web/page_engine.h"

namespace splatlas {

/// Six numbers of 32 bits: the status, the bytes of the text, and left, top, width and height of a part of
/// the picture; the text; and the part's pixels in 8-bit sRGB with straight alpha. Others are transparent.
/// An empty picture has a part of one pixel, other answers none. O(pixels), thread-safe.
[[nodiscard]] std::string call_answer(const PageAnswer& answer, const Picture& picture);

}  // namespace splatlas
