// JPEG 2000 images in memory. Errors go on after the file's name.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/result.h"
#include "preprocess/import/images/dicom/dicom_frame.h"

namespace splatlas {

/// Decodes a JPEG 2000 image of one component. kFailed if it has another size or more bits than `format`.
[[nodiscard]] Result<void> decode_jpeg_2000(std::span<const std::byte> bytes, const PixelFormat& format,
                                            std::vector<std::int32_t>& values);

}  // namespace splatlas
