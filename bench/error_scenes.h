// Scenes of the bench `error`.
#pragma once

#include <span>
#include <string>

#include "bench/frames.h"
#include "format/atlas_content.h"
#include "format/selection.h"
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

/// One scene with one transfer function, in the form that all renderers take.
struct ErrorModel {
  Selection selection;
  reference::MaskedVolume volume;
  reference::GreyAppearance appearance;
  Camera camera;  ///< camera of the first frame
};
[[nodiscard]] Result<ErrorModel> error_model(const AtlasContent& content, const ErrorScene& scene,
                                             const ErrorAppearance& appearance);

}  // namespace splatlas
