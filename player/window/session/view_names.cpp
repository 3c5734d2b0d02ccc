#include "player/window/session/view_names.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

/// Minimum component along an axis for its letter: sin 22.5 degrees.
constexpr double kMinComponent = 0.3827;

}  // namespace

std::string orientation_letters(const Vec3& direction_lps) {
  constexpr std::array<std::string_view, 3> kLetters{"LR", "PA", "SI"};  // towards + and -
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(direction_lps[a]) > std::abs(direction_lps[b]);
  });
  std::string letters;
  for (const std::size_t a : axes) {
    if (std::abs(direction_lps[a]) >= kMinComponent) letters += kLetters[a][direction_lps[a] < 0 ? 1 : 0];
  }
  return letters;
}

std::optional<NamedView> view_of(const Camera& camera) {
  constexpr double kSameDeg = 1e-6;
  for (const NamedView view : kNamedViews) {
    const Camera named = Camera::of(view);
    if (std::abs(std::remainder(camera.azimuth_deg - named.azimuth_deg, 360.0)) < kSameDeg &&
        std::abs(camera.elevation_deg - named.elevation_deg) < kSameDeg) {
      return view;
    }
  }
  return std::nullopt;
}

std::string_view title_of(NamedView view) {
  constexpr std::array<std::string_view, 6> kTitles{"Anterior", "Posterior", "Left",
                                                    "Right",    "Superior",  "Inferior"};
  return kTitles[static_cast<std::size_t>(view)];
}

}  // namespace splatlas
