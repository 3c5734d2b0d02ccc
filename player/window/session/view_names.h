// Names of views.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "player/camera.h"

namespace splatlas {

/// The standard views, in the order of their enumerators.
inline constexpr std::array<NamedView, 6> kNamedViews{NamedView::kAnterior, NamedView::kPosterior,
                                                      NamedView::kLeft,     NamedView::kRight,
                                                      NamedView::kSuperior, NamedView::kInferior};

/// The standard view with the camera's direction, if any. Ignores zoom and centre.
[[nodiscard]] std::optional<NamedView> view_of(const Camera& camera);
/// Title of a view: "Anterior", "Posterior", ... Its first letter is the key of the view.
[[nodiscard]] std::string_view title_of(NamedView view);

}  // namespace splatlas
