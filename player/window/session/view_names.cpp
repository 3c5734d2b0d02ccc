#include "player/window/session/view_names.h"

#include <cmath>

namespace splatlas {

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
