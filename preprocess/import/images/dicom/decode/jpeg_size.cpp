// Frame headers of JPEG (ITU-T T.81) and JPEG-LS (T.87).
#include "preprocess/import/images/dicom/decode/frame_codings.h"

namespace splatlas {
namespace {

constexpr unsigned kStuffing = 0xff;

/// Start of frame: SOF0 to SOF15 without DHT, JPG and DAC, and SOF55 of JPEG-LS.
bool starts_frame(unsigned marker) {
  constexpr unsigned kFirst = 0xc0, kLast = 0xcf, kHuffman = 0xc4, kReserved = 0xc8, kArithmetic = 0xcc,
                     kJpegLs = 0xf7;
  return marker == kJpegLs || (marker >= kFirst && marker <= kLast && marker != kHuffman &&
                               marker != kReserved && marker != kArithmetic);
}

}  // namespace

std::optional<JpegSize> jpeg_size(std::span<const std::byte> bytes) {
  constexpr unsigned kStartOfScan = 0xda;
  constexpr std::size_t kHeaderBytes = 8;
  const auto byte = [&](std::size_t at) { return std::to_integer<unsigned>(bytes[at]); };
  const auto word = [&](std::size_t at) { return 256 * byte(at) + byte(at + 1); };
  std::size_t at = 2;  // behind the start of the image
  while (at + 4 <= bytes.size()) {
    if (byte(at) != kStuffing) return std::nullopt;
    const unsigned marker = byte(at + 1);
    if (marker == kStuffing) {
      ++at;
      continue;
    }
    at += 2;
    if (marker == kStartOfScan) return std::nullopt;
    if (starts_frame(marker)) {
      if (at + kHeaderBytes > bytes.size()) return std::nullopt;
      return JpegSize{static_cast<int>(byte(at + 2)), static_cast<int>(word(at + 3)),
                      static_cast<int>(word(at + 5)), static_cast<int>(byte(at + 7))};
    }
    at += word(at);
  }
  return std::nullopt;
}

}  // namespace splatlas
