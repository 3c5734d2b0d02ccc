// Anatomical names of directions and views.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "player/camera.h"

namespace splatlas {

/// The standard views, in the order of their enumerators.
inline constexpr std::array<NamedView, 6> kNamedViews{NamedView::kAnterior, NamedView::kPosterior,
                                                      NamedView::kLeft,     NamedView::kRight,
                                                      NamedView::kSuperior, NamedView::kInferior};

/// Anatomical letters of a direction in LPS, largest component first: "L" for left, "LA" for left-anterior.
/// One letter within about 22 degrees of an axis.
[[nodiscard]] std::string orientation_letters(const Vec3& direction_lps);

/// The standard view with the camera's direction, if any. Ignores zoom and centre.
[[nodiscard]] std::optional<NamedView> view_of(const Camera& camera);
/// Title of a view: "Anterior", "Posterior", ... Its first letter is the key of the view.
[[nodiscard]] std::string_view title_of(NamedView view);

}  // namespace splatlas
