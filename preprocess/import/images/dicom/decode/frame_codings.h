// Codings of single frames in memory. Errors go on after the file's name.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "format/result.h"
#include "preprocess/import/images/dicom/dicom_frame.h"

namespace splatlas {

/// Size of a JPEG or JPEG-LS image.
struct JpegSize {
  int bits = 0, rows = 0, columns = 0, components = 0;
};
/// Reads the frame header. None if there is no complete one. Cost: the header's segments.
[[nodiscard]] std::optional<JpegSize> jpeg_size(std::span<const std::byte> bytes);

/// Decodes run-length coded values of `sample_bytes` bytes; `values` has the size of the frame.
[[nodiscard]] Result<void> decode_run_lengths(std::span<const std::byte> bytes, std::size_t sample_bytes,
                                              std::vector<std::int32_t>& values);

/// Decodes a JPEG 2000 image of one component. kFailed if its size is not that of `format`, or if it has more
/// bits.
[[nodiscard]] Result<void> decode_jpeg_2000(std::span<const std::byte> bytes, const PixelFormat& format,
                                            std::vector<std::int32_t>& values);

}  // namespace splatlas
