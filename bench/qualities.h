// Named qualities of the renderer, for table rows.
#pragma once

#include <array>

#include "player/render_frame.h"

namespace splatlas {

struct NamedQuality {
  const char* name;
  Quality quality;
};
inline constexpr std::array kQualities{NamedQuality{"draft", Quality::kDraft},
                                       NamedQuality{"normal", Quality::kNormal},
                                       NamedQuality{"high", Quality::kHigh}};

}  // namespace splatlas
