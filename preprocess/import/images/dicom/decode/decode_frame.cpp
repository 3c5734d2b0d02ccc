#include "preprocess/import/images/dicom/decode/decode_frame.h"

#include <cstring>

#include <dcmtk/dcmdata/dccodec.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/decode/frame_codings.h"
#include "preprocess/import/images/dicom/decode/frame_fragments.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/isolation/run_isolated.h"

namespace splatlas {
namespace {

void register_codecs() {
  static const bool done = [] {
    DJDecoderRegistration::registerCodecs(EDC_never, EUC_never);
    DJLSDecoderRegistration::registerCodecs(EJLSUC_never);
    return true;
  }();
  static_cast<void>(done);
}

constexpr const char* kDamaged = "has damaged pixels in frame {}; get the file again";

}  // namespace

DicomPixels::DicomPixels(const DicomFrame& frame)
    : path_(frame.file), format_(frame.pixels), frames_(frame.frames_of_file) {}
DicomPixels::~DicomPixels() = default;
DicomPixels::DicomPixels(DicomPixels&&) noexcept = default;
DicomPixels& DicomPixels::operator=(DicomPixels&&) noexcept = default;

Result<DicomPixels> DicomPixels::open(const DicomFrame& frame) {
  register_codecs();
  DicomPixels pixels(frame);
  SPLATLAS_ASSIGN_OR_RETURN(pixels.file_, open_dicom(frame.file, DicomPart::kWhole));
  SPLATLAS_RETURN_IF_ERROR(pixels.find_pixels());
  return pixels;
}

Result<void> DicomPixels::find_pixels() {
  DcmDataset& dataset = *file_->getDataset();
  DcmElement* element = nullptr;
  if (dataset.findAndGetElement(DCM_PixelData, element).good())
    pixels_ = dynamic_cast<DcmPixelData*>(element);
  if (pixels_ == nullptr) return bad_file(path_, "has no pixels: it is cut short; get the file again");
  const DcmXfer syntax(dataset.getOriginalXfer());
  if (!syntax.isEncapsulated()) return check_raw();
  switch (syntax.getXfer()) {
    case EXS_RLELossless: coding_ = Coding::kRunLengths; break;
    case EXS_JPEG2000LosslessOnly:
    case EXS_JPEG2000: coding_ = Coding::kJpeg2000; break;
    default: coding_ = Coding::kJpeg;
  }
  if (coding_ == Coding::kJpeg && !DcmCodecList::canChangeCoding(syntax.getXfer(), EXS_LittleEndianExplicit))
    return bad_file(path_, "has pixels in a coding that cannot be read ({}); convert it with gdcmconv --raw",
                    syntax.getXferID());
  if (coding_ != Coding::kRunLengths && format_.high_bit != format_.bits_stored - 1)
    return bad_file(path_, "has HighBit {} in compressed pixels of {} bits; convert it with gdcmconv --raw",
                    format_.high_bit, format_.bits_stored);
  if (format_.bits_allocated == 1)
    return bad_file(path_, "has compressed pixels of one bit, which cannot be; get the file again");
  return {};
}

Result<void> DicomPixels::check_raw() {
  const std::uint64_t bits =
      std::uint64_t{pixels_of_frame()} * static_cast<std::uint64_t>(format_.bits_allocated) * frames_;
  const std::uint64_t promised = (bits + 7) / 8, found = pixels_->getLength();
  if (found >= promised) return {};
  return bad_file(path_, "has {} bytes of pixels instead of {}; it is cut short: get the file again", found,
                  promised);
}

Result<void> DicomPixels::decode(std::uint32_t index, std::vector<std::int32_t>& values) {
  values.resize(pixels_of_frame());
  if (format_.bits_allocated == 1) return decode_bits(index, values);
  if (coding_ == Coding::kRaw) return decode_raw(index, values);
  if (coding_ == Coding::kJpeg) return decode_jpeg(index, values);
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, coded_frame(index));
  const bool is_jpeg_2000 = coding_ == Coding::kJpeg2000;
  const auto decoded =
      is_jpeg_2000 ? decode_jpeg_2000(bytes, format_, values)
                   : decode_run_lengths(bytes, static_cast<std::size_t>(format_.bits_allocated / 8), values);
  if (!decoded) return bad_file(path_, "{}", decoded.error().message);
  extract(values, is_jpeg_2000 ? 0 : low_bit());
  return {};
}

Result<void> DicomPixels::decode_raw(std::uint32_t index, std::vector<std::int32_t>& values) {
  const auto sample_bytes = static_cast<std::size_t>(format_.bits_allocated / 8);
  buffer_.assign(pixels_of_frame() * sample_bytes + 1, std::byte{0});
  if (!decompress(index)) return bad_file(path_, kDamaged, index + 1);
  unpack(sample_bytes, values);
  extract(values, low_bit());
  return {};
}

Result<void> DicomPixels::decode_jpeg(std::uint32_t index, std::vector<std::int32_t>& values) {
  // DCMTK fills a part of the buffer if an image is smaller than the header says, or has fewer bytes a pixel.
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, coded_frame(index));
  const std::optional<JpegSize> size = jpeg_size(bytes);
  if (!size) return bad_file(path_, kDamaged, index + 1);
  if (size->rows != format_.rows || size->columns != format_.columns || size->components != 1 ||
      size->bits > format_.bits_allocated) {
    return bad_file(path_, "has JPEG pixels of {}x{}, {} bits, instead of {}x{}, {}; get the file again",
                    size->columns, size->rows, size->bits, format_.columns, format_.rows,
                    format_.bits_allocated);
  }
  constexpr int kByte = 8;
  buffer_.assign(pixels_of_frame() * static_cast<std::size_t>(format_.bits_allocated / kByte) + 1,
                 std::byte{0});
  bool is_decoded = decompress(index);
  if (!is_decoded && index > 0) {
    // Without a table of frames, DCMTK finds a frame of several fragments only behind the one before it.
    is_decoded = true;
    for (std::uint32_t n = 0; n <= index && is_decoded; ++n) is_decoded = decompress(n);
  }
  if (!is_decoded) return bad_file(path_, kDamaged, index + 1);
  unpack(size->bits > kByte ? 2 : 1, values);
  extract(values, 0);
  return {};
}

void DicomPixels::unpack(std::size_t sample_bytes, std::vector<std::int32_t>& values) const {
  for (std::size_t v = 0; v < values.size(); ++v) {
    std::uint32_t bits = 0;  // this machine is little-endian, as DCMTK's buffers then are
    std::memcpy(&bits, &buffer_[v * sample_bytes], sample_bytes);
    values[v] = static_cast<std::int32_t>(bits);
  }
}

/// Fills buffer_ with a frame.
bool DicomPixels::decompress(std::uint32_t index) {
  if (index != next_frame_) next_fragment_ = 0;
  OFString ignored;
  const OFCondition status =
      pixels_->getUncompressedFrame(file_->getDataset(), index, next_fragment_, buffer_.data(),
                                    static_cast<Uint32>(buffer_.size()), ignored);
  next_frame_ = status.good() ? index + 1 : 0;
  if (status.bad()) next_fragment_ = 0;
  return status.good();
}

Result<void> DicomPixels::decode_bits(std::uint32_t index, std::vector<std::int32_t>& values) {
  if (packed_.empty()) {
    Uint8* bytes = nullptr;
    Uint16* words = nullptr;
    if (pixels_->getUint8Array(bytes).good() && bytes != nullptr) {
      packed_.assign(bytes, bytes + pixels_->getLength());
    } else if (pixels_->getUint16Array(words).good() && words != nullptr) {
      packed_.resize(pixels_->getLength());
      std::memcpy(packed_.data(), words, packed_.size());
    } else {
      return bad_file(path_, kDamaged, index + 1);
    }
  }
  // Frames follow each other without padding.
  const std::size_t first = std::size_t{index} * pixels_of_frame();
  for (std::size_t v = 0; v < values.size(); ++v)
    values[v] = (packed_[(first + v) / 8] >> ((first + v) % 8)) & 1;
  return {};
}

Result<std::vector<std::byte>> DicomPixels::coded_frame(std::uint32_t index) {
  auto bytes = frame_fragments(*pixels_, file_->getDataset()->getOriginalXfer(), frames_, index);
  if (!bytes) return bad_file(path_, kDamaged, index + 1);
  return *std::move(bytes);
}

void DicomPixels::extract(std::vector<std::int32_t>& values, int low_bit) const {
  constexpr int kWord = 32;
  const int left = kWord - low_bit - format_.bits_stored, right = kWord - format_.bits_stored;
  for (std::int32_t& value : values) {
    const std::uint32_t high = static_cast<std::uint32_t>(value) << left;
    value = format_.is_signed ? static_cast<std::int32_t>(high) >> right
                              : static_cast<std::int32_t>(high >> right);
  }
}

Result<std::span<const std::int32_t>> FrameDecoder::decode(const DicomFrame& frame) {
  report_child_progress(frame.file);
  if (!pixels_ || path_ != frame.file) {
    pixels_.reset();
    SPLATLAS_ASSIGN_OR_RETURN(pixels_, DicomPixels::open(frame));
    path_ = frame.file;
  }
  SPLATLAS_RETURN_IF_ERROR(pixels_->decode(frame.index, values_));
  return std::span<const std::int32_t>(values_);
}

}  // namespace splatlas
