// The scenes in which time is set against error.
#pragma once

#include <span>
#include <string>

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"
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
struct ErrorLook {
  const char* name;
  const char* options;  ///< of a selection text; colour and opacity
};
[[nodiscard]] std::span<const ErrorLook> error_looks();

/// One scene with one transfer function, as every renderer gets it.
struct ErrorModel {
  Selection selection;
  reference::MaskedVolume volume;
  reference::GreyLook look;
  Camera camera;  ///< of the first frame
};
[[nodiscard]] Result<ErrorModel> error_model(const AtlasContent& content, const ErrorScene& scene,
                                             const ErrorLook& look);

/// The camera of a turn: 15 degrees further each frame, a degree further each repeat.
[[nodiscard]] Camera turned(Camera camera, int turn, int frames);

}  // namespace splatlas
