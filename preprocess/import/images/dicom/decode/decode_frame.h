// Pixels of the frames of a DICOM file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "format/result.h"
#include "preprocess/import/images/dicom/dicom_frame.h"
#include "preprocess/import/images/dicom/dicom_item.h"

namespace splatlas {

/// An open file of frames: raw, deflated, RLE, JPEG, JPEG-LS and JPEG 2000 pixels. One thread at a time.
class DicomPixels {
 public:
  /// Opens the file of a frame. kFailed for damaged files, and if they hold fewer pixels than they promise.
  [[nodiscard]] static Result<DicomPixels> open(const DicomFrame& frame);

  /// Decodes frame `index` to its stored values: BitsStored bits up to HighBit, with their sign, row by row.
  /// kFailed for damaged pixels. Cost: the frame; raw pixels of other frames are not read.
  [[nodiscard]] Result<void> decode(std::uint32_t index, std::vector<std::int32_t>& values);

 private:
  explicit DicomPixels(const DicomFrame& frame);
  Result<void> find_pixels();
  Result<void> check_raw();
  Result<void> decode_raw(std::uint32_t index, std::vector<std::int32_t>& values);
  Result<void> decode_bits(std::uint32_t index, std::vector<std::int32_t>& values);
  bool decompress(std::uint32_t index);
  Result<void> decode_jpeg(std::uint32_t index, std::vector<std::int32_t>& values);
  Result<std::vector<std::byte>> coded_frame(std::uint32_t index);
  void unpack(std::size_t sample_bytes, std::vector<std::int32_t>& values) const;
  void extract(std::vector<std::int32_t>& values, int low_bit) const;
  [[nodiscard]] int low_bit() const { return format_.high_bit - format_.bits_stored + 1; }
  [[nodiscard]] std::size_t pixels_of_frame() const {
    return static_cast<std::size_t>(format_.rows) * static_cast<std::size_t>(format_.columns);
  }

  std::filesystem::path path_;
  PixelFormat format_;
  std::uint32_t frames_ = 1;
  std::unique_ptr<DcmFileFormat> file_;
  DcmPixelData* pixels_ = nullptr;  // owned by file_
  enum class Coding { kRaw, kRunLengths, kJpeg, kJpeg2000 } coding_ = Coding::kRaw;
  std::uint32_t next_fragment_ = 0;  // that of frame next_frame_; DCMTK searches if it is 0
  std::uint32_t next_frame_ = 0;
  std::vector<std::byte> buffer_;     // a frame before the extraction of its values
  std::vector<std::uint8_t> packed_;  // all frames of one bit a pixel
};

/// Decodes frames of many files; keeps the last file open. One thread at a time.
class FrameDecoder {
 public:
  /// The stored values of a frame, row by row, valid until the next call. Errors as in DicomPixels.
  [[nodiscard]] Result<std::span<const std::int32_t>> decode(const DicomFrame& frame);

 private:
  std::filesystem::path path_;
  std::optional<DicomPixels> pixels_;
  std::vector<std::int32_t> values_;
};

/// Decodes a JPEG 2000 image of one component. kFailed if it has another size or more bits than `format`.
[[nodiscard]] Result<void> decode_jpeg_2000(std::span<const std::byte> bytes, const PixelFormat& format,
                                            std::vector<std::int32_t>& values);

}  // namespace splatlas
