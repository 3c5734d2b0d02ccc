// Where the frames of a bench are seen from.
#pragma once

#include "player/camera.h"

namespace splatlas {

/// Off every symmetry: neither slices nor rays line up with voxels.
[[nodiscard]] Camera oblique_camera();

/// The camera of a turn, which draws frame `turn % frames`: 15 degrees further each frame, a degree further
/// each repeat, so that no view is drawn twice.
[[nodiscard]] Camera turned(Camera camera, int turn, int frames);

}  // namespace splatlas
