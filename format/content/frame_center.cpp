#include "format/content/frame_center.h"

#include "format/text/ascii_text.h"

namespace splatlas {

std::optional<FrameCenter> parse_center(std::string_view text) {
  if (const auto point = parse_numbers<3>(text)) {
    return is_within_reach(*point) ? std::optional<FrameCenter>(*point) : std::nullopt;
  }
  constexpr std::string_view kPointCharacters = "0123456789+-.,eE ";
  const bool is_point = text.find(',') != std::string_view::npos &&
                        text.find_first_not_of(kPointCharacters) == std::string_view::npos;
  if (text.empty() || is_point) return std::nullopt;
  return FrameCenter(std::string(text));
}

}  // namespace splatlas
