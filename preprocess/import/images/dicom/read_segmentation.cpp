#include "preprocess/import/images/dicom/read_segmentation.h"

#include <cmath>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/decode/decode_frame.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Header of a segmentation.
struct SegmentList {
  bool is_label_map = false;
  std::int32_t max_fraction = 1;        ///< of masks
  std::int32_t background = 0;          ///< of label maps
  std::vector<SourceSegment> segments;  ///< by their values, which are the segment numbers
  Notes notes;
};

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

void add_terms(DcmItem& segment, std::vector<Term>& terms) {
  DcmItem* const type = first_item(segment, DCM_SegmentedPropertyTypeCodeSequence);
  if (type == nullptr) return;
  if (auto code = code_in(*type)) terms.push_back({vocabulary_of(code->scheme), std::move(code->value)});
  for (DcmItem* const item : items_in(*type, DCM_SegmentedPropertyTypeModifierCodeSequence)) {
    if (const auto code = code_in(*item))
      terms.push_back({"modifier " + vocabulary_of(code->scheme), code->value});
  }
}

SourceSegment segment_in(DcmItem& item, std::int64_t number, Notes& notes) {
  SourceSegment segment = named_segment(text_in(item, DCM_SegmentLabel), number, notes);
  if (const auto lab = numbers_in<3>(item, DCM_RecommendedDisplayCIELabValue))
    segment.structure.color = color_of_lab(*lab);
  add_terms(item, segment.structure.terms);
  return segment;
}

Result<void> read_kind(DcmItem& dataset, const std::filesystem::path& path, SegmentList& list) {
  const std::string kind = text_in(dataset, DCM_SegmentationType);
  if (kind == "FRACTIONAL") {
    constexpr std::int64_t kByte = 255;
    const std::int64_t max = integer_in(dataset, DCM_MaximumFractionalValue).value_or(kByte);
    if (max < 1 || max > kByte)
      return bad_file(path, "has MaximumFractionalValue {}; it must be 1 to 255", max);
    list.max_fraction = static_cast<std::int32_t>(max);
  } else if (kind == "LABELMAP") {
    list.is_label_map = true;
    list.background = static_cast<std::int32_t>(
        std::clamp<std::int64_t>(integer_in(dataset, DCM_PixelPaddingValue).value_or(0), 0, 65535));
  } else if (kind != "BINARY") {
    return bad_file(path, "is a segmentation of an unknown type; known are BINARY, FRACTIONAL and LABELMAP");
  }
  return {};
}

/// kFailed for unknown kinds, and segment numbers that repeat or are out of range.
Result<SegmentList> read_segments(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto format, open_dicom(path, DicomPart::kHeader));
  DcmDataset& dataset = *format->getDataset();
  static_cast<void>(dataset.convertToUTF8());  // labels that are no UTF-8 afterwards are replaced
  SegmentList list;
  SPLATLAS_RETURN_IF_ERROR(read_kind(dataset, path, list));
  constexpr std::int64_t kMaxNumber = 65535;
  for (DcmItem* const item : items_in(dataset, DCM_SegmentSequence)) {
    const std::int64_t number = integer_in(*item, DCM_SegmentNumber).value_or(-1);
    if (list.is_label_map && (number == 0 || number == list.background)) continue;
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

/// Layers of segment numbers of type T.
template <typename T>
class Layers {
 public:
  Layers(const SlicedStack& stack, const SegmentList& list, const std::filesystem::path& path)
      : stack_(stack), list_(list), path_(path), layers_(stack.grid), plane_(layers_.plane()) {}

  Result<void> add_masks(std::vector<SourceSegment>& segments) {
    SPLATLAS_RETURN_IF_ERROR(check_numbers());
    for (SourceSegment& segment : segments) {
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<SliceMask> masks, masks_of(segment));
      segment.layer = layers_.add(masks, static_cast<T>(segment.value));
    }
    return {};
  }

  Result<void> add_labels() {
    for (std::size_t k = 0; k < stack_.slices.size(); ++k) {
      if (stack_.slices[k].empty()) continue;
      SPLATLAS_ASSIGN_OR_RETURN(const auto values, decoder_.decode(*stack_.slices[k].front()));
      for (std::size_t v = 0; v < plane_; ++v) {
        if (values[v] != list_.background) layers_.first()[k * plane_ + v] = static_cast<T>(values[v]);
      }
      for (std::size_t n = 1; n < stack_.slices[k].size(); ++n) note_duplicate(*stack_.slices[k][n], notes_);
    }
    return {};
  }

  void hand_over(SourceImage& image) {
    image.notes.add(notes_);
    layers_.hand_over(image);
  }

 private:
  /// Each frame must name a segment of the list.
  Result<void> check_numbers() {
    for (const auto& slice : stack_.slices) {
      for (const DicomFrame* frame : slice) {
        if (std::ranges::find(list_.segments, frame->segment, &SourceSegment::value) == list_.segments.end())
          return bad_file(path_, "has a frame of segment {}, which is not in its list", frame->segment);
      }
    }
    return {};
  }

  Result<std::vector<SliceMask>> masks_of(const SourceSegment& segment) {
    std::vector<SliceMask> masks;
    const std::int32_t max = list_.max_fraction;
    std::int32_t largest = 0;
    for (std::size_t k = 0; k < stack_.slices.size(); ++k) {
      bool is_first = true;
      for (const DicomFrame* frame : stack_.slices[k]) {
        if (frame->segment != segment.value) continue;
        if (!std::exchange(is_first, false)) {
          note_duplicate(*frame, notes_);
          continue;
        }
        SPLATLAS_ASSIGN_OR_RETURN(const auto values, decoder_.decode(*frame));
        largest = std::max(largest, std::ranges::max(values));
        SliceMask mask{k, std::vector<bool>(plane_)};
        for (std::size_t v = 0; v < plane_; ++v) mask.voxels[v] = 2 * values[v] > max;
        masks.push_back(std::move(mask));
      }
    }
    if (largest > 0 && 2 * largest <= max) {
      notes_.add("low-fractions", fmt::format("{} (largest {:.3g})", segment.structure.name,
                                              static_cast<double>(largest) / max));
    }
    return masks;
  }

  const SlicedStack& stack_;
  const SegmentList& list_;
  const std::filesystem::path& path_;
  MaskLayers<T> layers_;
  std::size_t plane_;
  FrameDecoder decoder_;
  Notes notes_;
};

template <typename T>
Result<void> fill(const SlicedStack& stack, SegmentList& list, const std::filesystem::path& path,
                  SourceImage& image) {
  Layers<T> layers(stack, list, path);
  image.segments = list.segments;
  if (list.is_label_map) {
    SPLATLAS_RETURN_IF_ERROR(layers.add_labels());
  } else {
    SPLATLAS_RETURN_IF_ERROR(layers.add_masks(image.segments));
  }
  layers.hand_over(image);
  return {};
}

}  // namespace

Result<SourceImage> read_segmentation(SlicedStack stack, const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(SegmentList list, read_segments(path));
  const DicomFrame& frame =
      **std::ranges::find_if(stack.slices, [](const auto& s) { return !s.empty(); })->begin();
  constexpr int kShort = 16;
  if (frame.pixels.is_signed || frame.pixels.bits_stored > kShort)
    return bad_file(path, "is a segmentation with signed numbers or more than 16 bits, which cannot be");
  SourceImage image;
  image.grid = stack.grid;
  image.is_segmentation = true;
  image.notes = std::move(stack.notes);
  image.notes.add(list.notes);
  constexpr int kByte = 8;
  const bool is_short =
      list.segments.back().value > 255 || (list.is_label_map && frame.pixels.bits_stored > kByte);
  if (is_short) {
    SPLATLAS_RETURN_IF_ERROR(fill<std::uint16_t>(stack, list, path, image));
  } else {
    SPLATLAS_RETURN_IF_ERROR(fill<std::uint8_t>(stack, list, path, image));
  }
  return image;
}

SourceSegment named_segment(std::string label, std::int64_t number, Notes& notes) {
  SourceSegment segment;
  segment.value = number;
  segment.structure.name = std::move(label);
  if (!check_structure_name(segment.structure.name)) {
    segment.structure.name = fmt::format("segment {}", number);
    notes.add("unnamed-segments", segment.structure.name);
  }
  return segment;
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
