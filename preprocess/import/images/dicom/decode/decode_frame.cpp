#include "preprocess/import/images/dicom/decode/decode_frame.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <dcmtk/dcmdata/dccodec.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>

#include "format/result_macros.h"
#include "preprocess/import/isolation/run_isolated.h"
#include "preprocess/import/tables/text_file.h"

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

/// The coded bytes of frame `index`. A frame may have several fragments, and often there is no table of
/// frames: then the signatures of JPEG and JPEG 2000 tell where frames start. None if that is unclear.
/// Cost: reads the fragments of the frame, and the starts of those before it.
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

void register_codecs() {
  [[maybe_unused]] static const bool kDone = [] {
    DJDecoderRegistration::registerCodecs(EDC_never, EUC_never);
    DJLSDecoderRegistration::registerCodecs(EJLSUC_never);
    return true;
  }();
}

constexpr const char* kDamaged = "has damaged pixels in frame {}; get the file again";

/// Size of a JPEG (ITU-T T.81) or JPEG-LS (T.87) image.
struct JpegSize {
  int bits = 0, rows = 0, columns = 0, components = 0;
};

constexpr unsigned kStuffing = 0xff;

/// Start of frame: SOF0 to SOF15 without DHT, JPG and DAC, and SOF55 of JPEG-LS.
bool starts_frame(unsigned marker) {
  constexpr unsigned kFirst = 0xc0, kLast = 0xcf, kHuffman = 0xc4, kReserved = 0xc8, kArithmetic = 0xcc,
                     kJpegLs = 0xf7;
  return marker == kJpegLs || (marker >= kFirst && marker <= kLast && marker != kHuffman &&
                               marker != kReserved && marker != kArithmetic);
}

/// Unpacks runs (PS3.5 annex G) until `bytes` are full. False if the runs end before, or one of them does.
bool unpack(std::span<const std::byte> runs, std::span<std::byte> bytes) {
  constexpr unsigned kNothing = 128, kRunBase = 257;  // codes of two's complement
  std::size_t at = 0, filled = 0;
  while (filled < bytes.size()) {
    if (at >= runs.size()) return false;
    const auto code = std::to_integer<unsigned>(runs[at++]);
    if (code == kNothing) continue;
    const bool is_literal = code < kNothing;
    const std::size_t count = is_literal ? code + 1 : kRunBase - code;
    const std::size_t needed = is_literal ? count : 1;
    if (runs.size() - at < needed || bytes.size() - filled < count) return false;
    if (is_literal) {
      std::copy_n(&runs[at], count, &bytes[filled]);
    } else {
      std::fill_n(&bytes[filled], count, runs[at]);
    }
    at += needed;
    filled += count;
  }
  return true;
}

/// Reads the frame header. None if there is no complete one. Cost: the header's segments.
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

/// Decodes run-length coded values of `sample_bytes` bytes; `values` has the size of the frame.
Result<void> decode_run_lengths(std::span<const std::byte> bytes, std::size_t sample_bytes,
                                std::vector<std::int32_t>& values) {
  // DCMTK's decoder fills up cut segments, with wrong pixels.
  const auto damaged = [] {
    return fail(ErrorCode::kFailed, std::string("has damaged run-length coded pixels; get the file again"));
  };
  constexpr std::size_t kMaxSegments = 15;
  std::array<std::uint32_t, kMaxSegments + 1> header{};  // number of segments, and where each starts
  if (bytes.size() < sizeof(header)) return damaged();
  std::memcpy(header.data(), bytes.data(), sizeof(header));
  if (header[0] != sample_bytes) return damaged();
  std::fill(values.begin(), values.end(), 0);
  std::vector<std::byte> plane(values.size());
  for (std::size_t n = 1; n <= sample_bytes; ++n) {
    const std::size_t start = header[n], end = n < sample_bytes ? header[n + 1] : bytes.size();
    if (start < sizeof(header) || start > end || end > bytes.size()) return damaged();
    if (!unpack(bytes.subspan(start, end - start), plane)) return damaged();
    // The most significant bytes come first.
    for (std::size_t v = 0; v < plane.size(); ++v) {
      const std::uint32_t higher = static_cast<std::uint32_t>(values[v]) << 8;
      values[v] = static_cast<std::int32_t>(higher | std::to_integer<std::uint32_t>(plane[v]));
    }
  }
  return {};
}

}  // namespace

DicomPixels::DicomPixels(const DicomFrame& frame)
    : path_(frame.file), format_(frame.pixels), frames_(frame.frames_of_file) {}

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
