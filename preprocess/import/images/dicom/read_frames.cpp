#include <algorithm>
#include <cmath>
#include <cstdint>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/dicom/dicom_frame.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/isolation/run_isolated.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

// Messages of these errors go on after the file's name.

/// Location of a frame's attributes. `shared` and `own` are null in classic images.
struct FrameGroups {
  DcmItem& dataset;
  DcmItem* shared = nullptr;
  DcmItem* own = nullptr;

  /// The item of a functional group, or the data set if there is none.
  [[nodiscard]] DcmItem& group(const DcmTagKey& sequence) const;
};

Result<void> check_format(const PixelFormat& pixels, bool is_segmentation) {
  const int allocated = pixels.bits_allocated;
  if (allocated != 8 && allocated != 16 && allocated != 32 && !(allocated == 1 && is_segmentation))
    return fail(ErrorCode::kFailed, "has BitsAllocated {}; supported are 8, 16 and 32", allocated);
  if (pixels.bits_stored < 1 || pixels.bits_stored > allocated)
    return fail(ErrorCode::kFailed, "has BitsStored {} of BitsAllocated {}, which cannot be; get it again",
                pixels.bits_stored, allocated);
  if (pixels.bits_stored == 32 && !pixels.is_signed)
    return fail(ErrorCode::kFailed,
                std::string("has unsigned pixels of 32 bits; supported are 31; convert it to NIfTI"));
  if (pixels.high_bit < pixels.bits_stored - 1 || pixels.high_bit >= allocated)
    return fail(ErrorCode::kFailed, "has HighBit {}, which contradicts BitsStored {}; get it again",
                pixels.high_bit, pixels.bits_stored);
  return {};
}

Result<void> check_kind(DcmItem& dataset) {
  if (dataset.tagExists(DCM_TotalPixelMatrixColumns))
    return fail(ErrorCode::kFailed, "is an image of a microscope slide, which has no place in a patient");
  if (integer_in(dataset, DCM_SamplesPerPixel).value_or(1) != 1 ||
      text_in(dataset, DCM_PhotometricInterpretation) == "PALETTE COLOR")
    return fail(ErrorCode::kFailed, "is a colour image; a volume has grey values: leave it out");
  if (dataset.tagExists(DCM_FloatPixelData) || dataset.tagExists(DCM_DoubleFloatPixelData))
    return fail(ErrorCode::kFailed, "has floating-point pixels (a parametric map); convert it to NIfTI");
  if (dataset.tagExists(DCM_ModalityLUTSequence))
    return fail(ErrorCode::kFailed, "has a table of values (modality LUT); convert it to NIfTI");
  return {};
}

std::string modality_of(DcmItem& dataset) {
  const std::string text = text_in(dataset, DCM_Modality);
  const auto is_code = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); };
  constexpr std::size_t kMaxLength = 16;  // of a code string
  return !text.empty() && text.size() <= kMaxLength && std::ranges::all_of(text, is_code) ? text : "image";
}

/// Makes the axes orthonormal. kFailed unless they nearly are.
Result<void> set_axes(const std::array<double, 6>& numbers, DicomFrame& frame) {
  constexpr double kTolerance = 1e-3;
  frame.row = {numbers[0], numbers[1], numbers[2]};
  frame.column = {numbers[3], numbers[4], numbers[5]};
  const double row_length = std::sqrt(dot(frame.row, frame.row));
  const double column_length = std::sqrt(dot(frame.column, frame.column));
  if (!(std::abs(row_length - 1) <= kTolerance && std::abs(column_length - 1) <= kTolerance &&
        std::abs(dot(frame.row, frame.column)) <= kTolerance))
    return fail(ErrorCode::kFailed, "has an orientation that is no rotation (ImageOrientationPatient)");
  for (double& x : frame.row) x /= row_length;
  const double lean = dot(frame.row, frame.column);
  for (std::size_t a = 0; a < 3; ++a) frame.column[a] -= lean * frame.row[a];
  const double length = std::sqrt(dot(frame.column, frame.column));
  for (double& x : frame.column) x /= length;
  return {};
}

Result<void> read_geometry(const FrameGroups& groups, DicomFrame& frame) {
  const auto position = numbers_in<3>(groups.group(DCM_PlanePositionSequence), DCM_ImagePositionPatient);
  const auto axes = numbers_in<6>(groups.group(DCM_PlaneOrientationSequence), DCM_ImageOrientationPatient);
  DcmItem& measures = groups.group(DCM_PixelMeasuresSequence);
  const auto spacing = numbers_in<2>(measures, DCM_PixelSpacing);
  if (!position || !axes || !spacing) {
    return fail(ErrorCode::kFailed,
                "has no {}: it is a projection or a screen copy, or lost its geometry; leave it out",
                !position ? "ImagePositionPatient" : (!axes ? "ImageOrientationPatient" : "PixelSpacing"));
  }
  if (!std::ranges::all_of(*position, is_plausible))
    return fail(ErrorCode::kFailed, "has a position that cannot be (ImagePositionPatient)");
  frame.position = *position;
  SPLATLAS_RETURN_IF_ERROR(set_axes(*axes, frame));
  if (!std::ranges::all_of(*spacing, [](double mm) { return mm > 0 && is_plausible(mm); }))
    return fail(ErrorCode::kFailed, "has PixelSpacing {} and {} mm; it must be positive", (*spacing)[0],
                (*spacing)[1]);
  frame.spacing = {(*spacing)[1], (*spacing)[0]};  // DICOM puts the spacing of rows first
  const auto length = [&](const DcmTagKey& tag) {
    const double mm = number_in(measures, tag).value_or(0);
    return mm > 0 && is_plausible(mm) ? mm : 0;
  };
  frame.slice_spacing = length(DCM_SpacingBetweenSlices);
  frame.thickness = length(DCM_SliceThickness);
  return {};
}

Result<void> read_scale(const FrameGroups& groups, DicomFrame& frame) {
  DcmItem& scale = groups.group(DCM_PixelValueTransformationSequence);
  const auto read = [&](const DcmTagKey& tag, double standard) -> std::optional<double> {
    if (!scale.tagExistsWithValue(tag)) return standard;
    return number_in(scale, tag);
  };
  const auto slope = read(DCM_RescaleSlope, 1), intercept = read(DCM_RescaleIntercept, 0);
  if (!slope || !intercept || *slope == 0 || !is_plausible(*slope) || !is_plausible(*intercept))
    return fail(ErrorCode::kFailed, "has a value scale that cannot be (RescaleSlope, RescaleIntercept)");
  frame.slope = *slope;
  frame.intercept = *intercept;
  return {};
}

/// Kinds of frames, from enhanced images' groups or from the data set.
void read_keys(const FrameGroups& groups, DicomFrame& frame) {
  const auto set = [&](SplitKey key, const DcmTagKey& group, const DcmTagKey& tag, const DcmTagKey& classic) {
    std::string& text = frame.split_keys[static_cast<std::size_t>(key)];
    if (text.empty()) text = text_in(groups.group(group), tag);
    if (text.empty()) text = text_in(groups.dataset, classic);
  };
  set(SplitKey::kEcho, DCM_MREchoSequence, DCM_EffectiveEchoTime, DCM_EchoNumbers);
  set(SplitKey::kTime, DCM_FrameContentSequence, DCM_TemporalPositionIndex, DCM_TemporalPositionIdentifier);
  for (const DcmTagKey& kind :
       {DCM_MRImageFrameTypeSequence, DCM_CTImageFrameTypeSequence, DCM_PETFrameTypeSequence})
    set(SplitKey::kImageType, kind, DCM_FrameType, DCM_FrameType);
  std::string& type = frame.split_keys[static_cast<std::size_t>(SplitKey::kImageType)];
  const std::string whole = text_in(groups.dataset, DCM_ImageType);
  if (type.empty()) type = whole;
  frame.is_mosaic = whole.find("MOSAIC") != std::string::npos;
  set(SplitKey::kAcquisition, DCM_FrameContentSequence, DCM_FrameAcquisitionNumber, DCM_AcquisitionNumber);
  set(SplitKey::kDiffusion, DCM_MRDiffusionSequence, DCM_DiffusionBValue, DCM_DiffusionBValue);
  set(SplitKey::kTrigger, DCM_CardiacSynchronizationSequence, DCM_NominalCardiacTriggerDelayTime,
      DCM_TriggerTime);
}

DcmItem& FrameGroups::group(const DcmTagKey& sequence) const {
  for (DcmItem* const item : {own, shared}) {
    if (DcmItem* const found = item == nullptr ? nullptr : first_item(*item, sequence)) return *found;
  }
  return dataset;
}

/// True for the storage classes of segmentations with voxels.
bool is_segmentation_class(const std::string& class_uid) {
  return class_uid == "1.2.840.10008.5.1.4.1.1.66.4" || class_uid == "1.2.840.10008.5.1.4.1.1.66.7";
}

/// Reads what all frames of a file share: series and pixel format. kFailed for colour, contradictory pixel
/// formats, modality tables and float pixels.
Result<void> read_common(DcmItem& dataset, DicomFrame& frame) {
  SPLATLAS_RETURN_IF_ERROR(check_kind(dataset));
  constexpr std::int64_t kNone = -1;
  const auto number = [&](const DcmTagKey& tag, std::int64_t otherwise) {
    return static_cast<int>(
        std::clamp<std::int64_t>(integer_in(dataset, tag).value_or(otherwise), -1, 65536));
  };
  PixelFormat& pixels = frame.pixels;
  pixels.rows = number(DCM_Rows, kNone);
  pixels.columns = number(DCM_Columns, kNone);
  pixels.bits_allocated = number(DCM_BitsAllocated, kNone);
  pixels.bits_stored = number(DCM_BitsStored, kNone);
  pixels.high_bit = number(DCM_HighBit, kNone);
  const int sign = number(DCM_PixelRepresentation, frame.is_segmentation ? 0 : kNone);
  if (pixels.rows < 1 || pixels.columns < 1)
    return fail(ErrorCode::kFailed, "has {} rows and {} columns; get the file again", pixels.rows,
                pixels.columns);
  if (pixels.bits_allocated < 0 || pixels.bits_stored < 0 || pixels.high_bit < 0 || sign < 0)
    return fail(ErrorCode::kFailed,
                "does not say how its pixels are stored (BitsAllocated, BitsStored, HighBit, "
                "PixelRepresentation); get the file again");
  pixels.is_signed = sign != 0;
  SPLATLAS_RETURN_IF_ERROR(check_format(pixels, frame.is_segmentation));
  frame.is_inverted = text_in(dataset, DCM_PhotometricInterpretation) == "MONOCHROME1";
  frame.series_uid = text_in(dataset, DCM_SeriesInstanceUID);
  frame.frame_of_reference = text_in(dataset, DCM_FrameOfReferenceUID);
  frame.series_number = integer_in(dataset, DCM_SeriesNumber).value_or(0);
  frame.modality = modality_of(dataset);
  return {};
}

/// kFailed if a file of `count` frames has not `groups` functional groups, and for images of slides.
Result<void> check_frame_count(DcmItem& dataset, std::int64_t count, std::size_t groups) {
  constexpr std::int64_t kMaxFrames = 1 << 20;
  if (dataset.tagExistsWithValue(DCM_NumberOfFrames) && !integer_in(dataset, DCM_NumberOfFrames)) count = 0;
  if (count < 1 || count > kMaxFrames)
    return fail(ErrorCode::kFailed, "has NumberOfFrames {}, which cannot be; get the file again", count);
  if (groups == static_cast<std::size_t>(count) || (groups == 0 && count == 1)) return {};
  if (groups == 0) {
    return fail(
        ErrorCode::kFailed,
        "has {} frames without a position for each (a film, a scintigram or a dose); convert it to NIfTI",
        count);
  }
  return fail(ErrorCode::kFailed, "has {} frames, but the geometry of {}; get the file again", count, groups);
}

/// Reads a frame's geometry, value scale, segment and kind. kFailed without a geometry that rotates.
Result<void> read_frame(const FrameGroups& groups, DicomFrame& frame) {
  SPLATLAS_RETURN_IF_ERROR(read_geometry(groups, frame));
  if (!frame.is_segmentation) {
    SPLATLAS_RETURN_IF_ERROR(read_scale(groups, frame));
  } else {
    const auto segment =
        integer_in(groups.group(DCM_SegmentIdentificationSequence), DCM_ReferencedSegmentNumber).value_or(0);
    frame.segment = static_cast<std::uint16_t>(std::clamp<std::int64_t>(segment, 0, 65535));
  }
  read_keys(groups, frame);
  return {};
}

/// True for storage classes of images, which must have pixels.
bool is_image_class(const std::string& uid) {
  const char* const name = dcmFindNameOfUID(uid.c_str());
  const std::string class_name = name == nullptr ? "" : name;
  return class_name.find("Image") != std::string::npos || is_segmentation_class(uid);
}

bool has_dicom_ending(const std::filesystem::path& file) {
  const std::string ending = to_lower(file.extension().string());
  return ending == ".dcm" || ending == ".dicom" || ending == ".ima";
}

class FramesOfFile {
 public:
  FramesOfFile(const std::filesystem::path& file, bool is_only_file, DicomFrames& found)
      : file_(file), is_only_file_(is_only_file), found_(found) {}

  void add() {
    report_child_progress(file_);
    if (!begins_as_dicom(file_)) {
      if (is_only_file_ || has_dicom_ending(file_))
        fault("is no DICOM file (\"DICM\" is missing at byte 128); convert it with dcmconv, or leave it out");
      return;
    }
    const auto format = open_dicom(file_, DicomPart::kHeader);
    if (!format) {
      found_.faults.push_back({"", format.error().message});
      return;
    }
    DcmItem& dataset = *(*format)->getDataset();
    std::string class_uid = text_in(*(*format)->getMetaInfo(), DCM_MediaStorageSOPClassUID);
    if (class_uid.empty()) class_uid = text_in(dataset, DCM_SOPClassUID);
    series_uid_ = text_in(dataset, DCM_SeriesInstanceUID);
    if (class_uid == UID_RTStructureSetStorage) {
      DcmItem* const structure = first_item(dataset, DCM_StructureSetROISequence);
      found_.contours.push_back(
          {file_, structure == nullptr ? "" : text_in(*structure, DCM_ReferencedFrameOfReferenceUID)});
      return;
    }
    if (!integer_in(dataset, DCM_Rows)) {
      if (is_image_class(class_uid)) {
        fault("has no pixels (Rows is missing): it is cut short; get the file again");
      } else if (is_only_file_) {
        fault("holds no image (a report, an index or a plan); give a file or folder with images");
      }
      return;
    }
    if (auto added = add_frames(dataset, class_uid); !added) fault(added.error().message);
  }

 private:
  void fault(const std::string& text) {
    found_.faults.push_back({series_uid_, file_.string() + ": " + text});
  }

  Result<void> add_frames(DcmItem& dataset, const std::string& class_uid) {
    DicomFrame common;
    common.file = file_;
    common.is_segmentation = is_segmentation_class(class_uid);
    SPLATLAS_RETURN_IF_ERROR(read_common(dataset, common));
    const std::int64_t count = integer_in(dataset, DCM_NumberOfFrames).value_or(1);
    const std::vector<DcmItem*> groups = items_in(dataset, DCM_PerFrameFunctionalGroupsSequence);
    SPLATLAS_RETURN_IF_ERROR(check_frame_count(dataset, count, groups.size()));
    common.frames_of_file = static_cast<std::uint32_t>(count);
    DcmItem* const shared = first_item(dataset, DCM_SharedFunctionalGroupsSequence);
    std::vector<DicomFrame> frames;
    for (std::size_t n = 0; n < static_cast<std::size_t>(count); ++n) {
      DicomFrame& frame = frames.emplace_back(common);
      frame.index = static_cast<std::uint32_t>(n);
      SPLATLAS_RETURN_IF_ERROR(read_frame({dataset, shared, groups.empty() ? nullptr : groups[n]}, frame));
    }
    std::ranges::move(frames, std::back_inserter(found_.frames));
    return {};
  }

  const std::filesystem::path& file_;
  bool is_only_file_;
  DicomFrames& found_;
  std::string series_uid_;
};

}  // namespace

Result<DicomFrames> read_frames(const std::filesystem::path& file_or_folder) {
  DicomFrames found;
  std::error_code error;
  for (const std::filesystem::path& file : regular_files_of(file_or_folder, error))
    FramesOfFile(file, file == file_or_folder, found).add();
  if (error) return bad_file(file_or_folder, "cannot be listed ({})", error.message());
  return found;
}

}  // namespace splatlas
