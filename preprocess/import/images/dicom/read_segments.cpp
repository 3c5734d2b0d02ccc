#include "preprocess/import/images/dicom/read_segments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/structure_name.h"

namespace splatlas {
namespace {

struct Code {
  std::string scheme, value;
};

/// A coded concept without its meaning, which is free text.
std::optional<Code> code_in(DcmItem& item) {
  Code code{text_in(item, DCM_CodingSchemeDesignator), text_in(item, DCM_CodeValue)};
  if (code.value.empty()) code.value = text_in(item, DCM_LongCodeValue);
  if (code.scheme.empty() || code.value.empty() || !check_structure_name(code.scheme) ||
      !check_structure_name(code.value))
    return std::nullopt;
  return code;
}

void add_terms(DcmItem& segment, std::vector<SourceTerm>& terms) {
  DcmItem* const type = first_item(segment, DCM_SegmentedPropertyTypeCodeSequence);
  if (type == nullptr) return;
  if (auto code = code_in(*type)) terms.push_back({vocabulary_of(code->scheme), std::move(code->value)});
  for (DcmItem* const item : items_in(*type, DCM_SegmentedPropertyTypeModifierCodeSequence)) {
    if (const auto code = code_in(*item))
      terms.push_back({"modifier " + vocabulary_of(code->scheme), code->value});
  }
}

SourceSegment segment_in(DcmItem& item, std::int64_t number, Notes& notes) {
  static const NoteKind kUnnamed{"unnamed-segments", "segment has a label that cannot be a name",
                                 "segments have labels that cannot be names"};
  SourceSegment segment;
  segment.value = number;
  segment.structure.name = text_in(item, DCM_SegmentLabel);
  if (!check_structure_name(segment.structure.name)) {
    segment.structure.name = fmt::format("segment {}", number);
    notes.add(kUnnamed, segment.structure.name);
  }
  if (const auto lab = numbers_in<3>(item, DCM_RecommendedDisplayCIELabValue))
    segment.structure.color = color_of_lab(*lab);
  add_terms(item, segment.structure.terms);
  return segment;
}

Result<void> read_kind(DcmItem& dataset, const std::filesystem::path& path, SegmentList& list) {
  const std::string kind = text_in(dataset, DCM_SegmentationType);
  if (kind == "BINARY") {
    list.kind = SegmentationKind::kBinary;
  } else if (kind == "FRACTIONAL") {
    list.kind = SegmentationKind::kFractional;
    constexpr std::int64_t kByte = 255;
    const std::int64_t max = integer_in(dataset, DCM_MaximumFractionalValue).value_or(kByte);
    if (max < 1 || max > kByte)
      return bad_file(path, "has MaximumFractionalValue {}; it must be 1 to 255", max);
    list.max_fraction = static_cast<std::int32_t>(max);
  } else if (kind == "LABELMAP") {
    list.kind = SegmentationKind::kLabelMap;
    list.background = static_cast<std::int32_t>(
        std::clamp<std::int64_t>(integer_in(dataset, DCM_PixelPaddingValue).value_or(0), 0, 65535));
  } else {
    return bad_file(path, "is a segmentation of an unknown type; known are BINARY, FRACTIONAL and LABELMAP");
  }
  return {};
}

}  // namespace

Result<SegmentList> read_segments(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto format, open_dicom(path, DicomPart::kHeader));
  DcmDataset& dataset = *format->getDataset();
  static_cast<void>(dataset.convertToUTF8());  // labels that are no UTF-8 afterwards are replaced
  SegmentList list;
  SPLATLAS_RETURN_IF_ERROR(read_kind(dataset, path, list));
  constexpr std::int64_t kMaxNumber = 65535;
  const bool is_label_map = list.kind == SegmentationKind::kLabelMap;
  for (DcmItem* const item : items_in(dataset, DCM_SegmentSequence)) {
    const std::int64_t number = integer_in(*item, DCM_SegmentNumber).value_or(-1);
    if (is_label_map && (number == 0 || number == list.background)) continue;
    if (number < 1 || number > kMaxNumber)
      return bad_file(path, "has a segment with number {}; it must be 1 to 65535", number);
    list.segments.push_back(segment_in(*item, number, list.notes));
  }
  std::ranges::stable_sort(list.segments, {}, &SourceSegment::value);
  const auto twice = std::ranges::adjacent_find(list.segments, {}, &SourceSegment::value);
  if (twice != list.segments.end())
    return bad_file(path, "has two segments with number {}; give each its own", twice->value);
  if (list.segments.empty()) return bad_file(path, "is a segmentation without segments");
  return list;
}

Rgb color_of_lab(const std::array<double, 3>& encoded) {
  // IEC 61966-2-1 and CIE 15; PS3.3 C.10.7.1.1 for the encoding.
  constexpr double kMax = 65535, kEpsilon = 6.0 / 29;
  const double l = encoded[0] / kMax * 100, a = encoded[1] / kMax * 255 - 128,
               b = encoded[2] / kMax * 255 - 128;
  const auto inverse = [](double t) {
    return t > kEpsilon ? t * t * t : 3 * kEpsilon * kEpsilon * (t - 4.0 / 29);
  };
  const double fy = (l + 16) / 116;
  const double x = 0.95047 * inverse(fy + a / 500), y = inverse(fy), z = 1.08883 * inverse(fy - b / 200);
  const auto channel = [](double linear) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(encode_srgb(linear), 0.0, 1.0) * 255));
  };
  return {channel(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          channel(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          channel(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

}  // namespace splatlas
