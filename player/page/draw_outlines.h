// Outlines of the structures in a finished picture.
#pragma once

#include "player/picture.h"

namespace splatlas {

/// Darkens a picture at its outlines: between pixels that show different structures, and where depths of
/// neighbours differ by more than 12 pixels, as at folds; not between translucent pixels. Lines are a pixel
/// wide, or a 900th of the picture's short side, with soft edges. `ids` and `depths`: of one frame.
void draw_outlines(const IdImage& ids, const DepthMap& depths, double mm_per_pixel, Picture& picture);

}  // namespace splatlas
