// Scenes of the bench `error`, in the form that all renderers take.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "player/camera.h"
#include "tests/reference/masked_volume.h"

namespace splatlas {

/// A part of the Colin 27 head.
struct ErrorScene {
  const char* name;
  const char* structures;  ///< structure names of a selection text, separated by " + "
  bool fills_picture;      ///< zoomed in; else the view of the whole head
};
[[nodiscard]] std::span<const ErrorScene> error_scenes();

/// A transfer function, as options of a selection text.
struct ErrorAppearance {
  const char* name;
  const char* options;  ///< options of a selection text; colour and opacity
};
[[nodiscard]] std::span<const ErrorAppearance> error_appearances();

/// "NAME:volume(OPTIONS) + ...": the structures as volume with one appearance.
[[nodiscard]] std::string selection_text(std::string_view structures, std::string_view options);

/// A selection whose volumes have one appearance, in the form that all renderers take.
struct ErrorModel {
  Selection selection;
  reference::MaskedVolume volume;
  reference::GreyAppearance appearance;
  Camera camera;  ///< camera of the first frame
};
[[nodiscard]] Result<ErrorModel> error_model(const AtlasContent& content, std::string_view selection);
/// One scene with one transfer function.
[[nodiscard]] Result<ErrorModel> error_model(const AtlasContent& content, const ErrorScene& scene,
                                             const ErrorAppearance& appearance);

}  // namespace splatlas
