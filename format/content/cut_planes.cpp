#include "format/content/cut_planes.h"

#include <algorithm>
#include <cmath>

#include "format/result_macros.h"
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

Result<void> CutPlanes::add(const CutPlane& plane) {
  const auto& [x, y, z] = plane.normal_lps;
  const double length = std::hypot(x, y, z);
  const bool is_valid = std::isfinite(length) && length > 0 && std::isfinite(plane.offset_mm / length);
  if (!is_valid) {
    return fail(ErrorCode::kUsage,
                "cut: the plane {},{},{},{} must have finite numbers and a normal other than 0", x, y, z,
                plane.offset_mm);
  }
  if (size_ == kMax) {
    return fail(ErrorCode::kUsage, "cut: more than {} planes; remove some", kMax);
  }
  planes_[size_++] = plane;
  return {};
}

std::optional<CutPlane> parse_cut(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, Vec3>, 6> kSides{{{"left", {1, 0, 0}},
                                                                            {"right", {-1, 0, 0}},
                                                                            {"anterior", {0, -1, 0}},
                                                                            {"posterior", {0, 1, 0}},
                                                                            {"superior", {0, 0, 1}},
                                                                            {"inferior", {0, 0, -1}}}};
  if (const std::size_t equals = text.find('='); equals != std::string_view::npos) {
    const auto side =
        std::ranges::find(kSides, text.substr(0, equals), &std::pair<std::string_view, Vec3>::first);
    const auto mm = parse_number<double>(text.substr(equals + 1));
    if (side == kSides.end() || !mm) return std::nullopt;
    return CutPlane{side->second, *mm};
  }
  const auto numbers = parse_numbers<4>(text);
  if (!numbers) return std::nullopt;
  return CutPlane{{(*numbers)[0], (*numbers)[1], (*numbers)[2]}, (*numbers)[3]};
}

Result<CutPlanes> parse_cuts(std::string_view text) {
  CutPlanes cuts;
  for (const std::string_view word : split(text, ' ')) {
    if (word.empty()) continue;
    const auto plane = parse_cut(word);
    if (!plane) return fail(ErrorCode::kUsage, "cut {}: {}", in_quotes(word), kCutForms);
    SPLATLAS_RETURN_IF_ERROR(cuts.add(*plane));
  }
  return cuts;
}

}  // namespace splatlas
