// Attributes of one frame: of its own functional groups, of the shared ones, or of the data set.
#pragma once

#include <cstdint>
#include <string>

#include "format/result.h"
#include "preprocess/import/images/dicom/dicom_frame.h"
#include "preprocess/import/images/dicom/dicom_item.h"

namespace splatlas {

// Messages of these errors go on after the file's name.

/// Location of a frame's attributes. `shared` and `own` are null in classic images.
struct FrameGroups {
  DcmItem& dataset;
  DcmItem* shared = nullptr;
  DcmItem* own = nullptr;

  /// The item of a functional group, or the data set if there is none.
  [[nodiscard]] DcmItem& group(const DcmTagKey& sequence) const;
};

/// True for the storage classes of segmentations with voxels.
[[nodiscard]] bool is_segmentation_class(const std::string& class_uid);

/// Reads what all frames of a file share: series and pixel format. kFailed for colour, contradictory pixel
/// formats, modality tables and float pixels.
[[nodiscard]] Result<void> read_common(DcmItem& dataset, DicomFrame& frame);

/// kFailed if a file of `count` frames has not `groups` functional groups, and for images of slides.
[[nodiscard]] Result<void> check_frame_count(DcmItem& dataset, std::int64_t count, std::size_t groups);

/// Reads a frame's geometry, value scale, segment and kind. kFailed if the geometry is missing or no
/// rotation.
[[nodiscard]] Result<void> read_frame(const FrameGroups& groups, DicomFrame& frame);

}  // namespace splatlas
