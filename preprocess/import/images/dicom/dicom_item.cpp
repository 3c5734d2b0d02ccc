#include "preprocess/import/images/dicom/dicom_item.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

constexpr std::string_view kPadding{" \0\t", 3};

std::string_view without_padding(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kPadding);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kPadding) - first + 1);
}

std::optional<double> parsed(std::string_view text) {
  const auto number = parse_number(without_padding(text));
  return number && std::isfinite(*number) ? number : std::nullopt;
}

/// True for two attributes of groups 2 or 8, little endian, in ascending order: files without a preamble.
bool begins_as_data_set(std::string_view bytes) {
  const auto is_capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  const auto number = [&](std::size_t at, std::size_t count) {
    std::size_t value = 0;
    while (count-- > 0) value = value << 8 | static_cast<unsigned char>(bytes[at + count]);
    return value;
  };
  std::size_t last = 0;
  for (std::size_t at = 0, n = 0; n < 2; ++n) {
    if (at + 8 > bytes.size()) return false;
    const std::size_t group = number(at, 2), tag = group << 16 | number(at + 2, 2);
    if ((group != 2 && group != 8) || tag <= std::exchange(last, tag)) return false;
    const bool is_explicit = is_capital(bytes[at + 4]) && is_capital(bytes[at + 5]);
    at += 8 + (is_explicit ? number(at + 6, 2) : number(at + 4, 4));
  }
  return true;
}

bool has_preamble(std::string_view bytes) {
  constexpr std::size_t kPreamble = 128;
  return bytes.size() > kPreamble && bytes.substr(kPreamble).starts_with("DICM");
}

}  // namespace

void prepare_dcmtk() {
  [[maybe_unused]] static const bool kDone = [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    dcmEnableUnknownVRConversion.set(OFTrue);
    return true;
  }();
}

bool begins_as_dicom(const std::filesystem::path& file) {
  const std::string bytes = first_bytes(file, kHeadBytes);
  return has_preamble(bytes) || begins_as_data_set(bytes);
}

Result<std::unique_ptr<DcmFileFormat>> open_dicom(const std::filesystem::path& file, DicomPart part) {
  constexpr Uint32 kMaxInMemory = 4096;
  prepare_dcmtk();
  auto format = std::make_unique<DcmFileFormat>();
  const OFFilename name(file.c_str());
  const E_FileReadMode mode = has_preamble(first_bytes(file, kHeadBytes)) ? ERM_fileOnly : ERM_autoDetect;
  const OFCondition status =
      part == DicomPart::kWhole
          ? format->loadFile(name, EXS_Unknown, EGL_noChange, kMaxInMemory, mode)
          : format->loadFileUntilTag(name, EXS_Unknown, EGL_noChange, kMaxInMemory, mode, DCM_PixelData);
  if (status.bad())  // its text may quote the header
    return bad_file(file, "is damaged or cut short, or in an unknown transfer syntax; get the file again");
  return format;
}

std::optional<double> number_in(DcmItem& item, const DcmTagKey& tag, unsigned long n) {
  DcmElement* element = nullptr;
  if (item.findAndGetElement(tag, element).bad() || element == nullptr) return std::nullopt;
  // Text of floating-point attributes is rounded.
  if (element->ident() == EVR_FD) {
    Float64 value = 0;
    if (element->getFloat64(value, n).bad() || !std::isfinite(value)) return std::nullopt;
    return value;
  }
  if (element->ident() == EVR_FL) {
    Float32 value = 0;
    if (element->getFloat32(value, n).bad() || !std::isfinite(value)) return std::nullopt;
    return static_cast<double>(value);
  }
  OFString text;
  if (element->getOFString(text, n).bad()) return std::nullopt;
  return parsed({text.data(), text.size()});
}

std::optional<std::int64_t> integer_in(DcmItem& item, const DcmTagKey& tag) {
  constexpr double kMax = 1e15;  // exact in a double
  const std::optional<double> number = number_in(item, tag);
  if (!number || std::abs(*number) > kMax || std::trunc(*number) < *number || std::trunc(*number) > *number)
    return std::nullopt;
  return static_cast<std::int64_t>(*number);
}

std::string text_in(DcmItem& item, const DcmTagKey& tag) {
  OFString text;
  if (item.findAndGetOFStringArray(tag, text).bad()) return {};
  return std::string(without_padding({text.data(), text.size()}));
}

std::vector<DcmItem*> items_in(DcmItem& item, const DcmTagKey& sequence) {
  DcmSequenceOfItems* found = nullptr;
  if (item.findAndGetSequence(sequence, found).bad() || found == nullptr) return {};
  std::vector<DcmItem*> items;
  for (DcmObject* next = found->nextInContainer(nullptr); next != nullptr;
       next = found->nextInContainer(next)) {
    if (auto* const one = dynamic_cast<DcmItem*>(next)) items.push_back(one);
  }
  return items;
}

DcmItem* first_item(DcmItem& item, const DcmTagKey& sequence) {
  const std::vector<DcmItem*> items = items_in(item, sequence);
  return items.empty() ? nullptr : items.front();
}

}  // namespace splatlas
