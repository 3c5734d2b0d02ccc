#include "preprocess/import/images/dicom/decode/frame_fragments.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>

namespace splatlas {
namespace {

/// True for the first fragment of an image.
bool starts_image(DcmPixelItem& item) {
  constexpr std::array<Uint8, 3> kJpeg{0xff, 0xd8, 0xff}, kCodestream{0xff, 0x4f, 0xff};
  constexpr std::array<Uint8, 8> kJpeg2000File{0, 0, 0, 12, 'j', 'P', ' ', ' '};
  Uint8* start = nullptr;
  if (item.getLength() < kJpeg2000File.size() || item.getUint8Array(start).bad() || start == nullptr)
    return false;
  const auto begins_with = [&](const auto& mark) { return std::equal(mark.begin(), mark.end(), start); };
  return begins_with(kJpeg) || begins_with(kCodestream) || begins_with(kJpeg2000File);
}

}  // namespace

std::optional<std::vector<std::byte>> frame_fragments(DcmPixelData& pixels, E_TransferSyntax syntax,
                                                      std::uint32_t frames, std::uint32_t index) {
  DcmPixelSequence* sequence = nullptr;
  if (pixels.getEncapsulatedRepresentation(syntax, nullptr, sequence).bad() || sequence == nullptr)
    return std::nullopt;
  std::vector<std::byte> bytes;
  std::uint32_t started = 0;
  const bool is_one_each = sequence->card() == std::size_t{frames} + 1;
  DcmObject* next = sequence->nextInContainer(nullptr);  // the table of frames
  while (next != nullptr && (next = sequence->nextInContainer(next)) != nullptr && started <= index + 1) {
    auto* const item = dynamic_cast<DcmPixelItem*>(next);
    if (item == nullptr) return std::nullopt;
    if (frames > 1 || started == 0) {
      if (is_one_each || started == 0 || starts_image(*item)) ++started;
      if (started > frames) return std::nullopt;
    }
    Uint8* start = nullptr;
    if (started != index + 1 || item->getUint8Array(start).bad() || start == nullptr) continue;
    const auto* const data = reinterpret_cast<const std::byte*>(start);
    bytes.insert(bytes.end(), data, data + item->getLength());
  }
  if (bytes.empty()) return std::nullopt;
  return bytes;
}

}  // namespace splatlas
