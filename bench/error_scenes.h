// The scenes in which time is set against error.
#pragma once

#include <span>
#include <string>

#include "bench/turned_camera.h"
#include "format/atlas_content.h"
#include "format/selection.h"
#include "tests/reference/masked_volume.h"

namespace splatlas {

/// A part of the Colin 27 head.
struct ErrorScene {
  const char* name;
  const char* structures;  ///< as names of a selection text, parted by " + "
  bool fills_picture;      ///< zoomed to; else seen from where the whole head is
};
[[nodiscard]] std::span<const ErrorScene> error_scenes();

/// A transfer function: what is written behind a structure's name.
struct ErrorAppearance {
  const char* name;
  const char* options;  ///< of a selection text; colour and opacity
};
[[nodiscard]] std::span<const ErrorAppearance> error_appearances();

/// One scene with one transfer function, as every renderer gets it.
struct ErrorModel {
  Selection selection;
  reference::MaskedVolume volume;
  reference::GreyAppearance appearance;
  Camera camera;  ///< of the first frame
};
[[nodiscard]] Result<ErrorModel> error_model(const AtlasContent& content, const ErrorScene& scene,
                                             const ErrorAppearance& appearance);

}  // namespace splatlas
