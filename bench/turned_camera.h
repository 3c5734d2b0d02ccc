// Cameras of bench frames.
#pragma once

#include "player/camera.h"

namespace splatlas {

/// Off all symmetries: neither slices nor rays align with voxels.
[[nodiscard]] Camera oblique_camera();

/// The camera of a turn, which draws frame `turn % frames`: 15 degrees per frame, and a further degree per
/// repeat, so that no view repeats.
[[nodiscard]] Camera turned(Camera camera, int turn, int frames);

}  // namespace splatlas
