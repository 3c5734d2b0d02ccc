// Values of a stack of frames.
#pragma once

#include "format/content/voxel_type.h"
#include "format/result.h"
#include "preprocess/import/images/dicom/stack_frames.h"

namespace splatlas {

/// Decodes the first frame of each slice and applies its slope and intercept. int16 or uint16 if they hold
/// all values exactly: every slope is 1 and every intercept is whole. Else float32. Padding keeps its value.
/// Further frames of a slice are ignored and noted. kFailed for damaged files. Cost: one pass; memory for
/// the volume, and twice as much for values of more than 16 bits. One thread at a time.
[[nodiscard]] Result<VoxelBuffer> read_volume(const SlicedStack& stack, Notes& notes);

}  // namespace splatlas
