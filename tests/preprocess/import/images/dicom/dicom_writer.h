// Parts of DICOM files, by DCMTK. They throw std::runtime_error.
#pragma once

#include <stdexcept>
#include <string>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <fmt/format.h>

#include "tests/preprocess/import/images/dicom/dicom_files.h"

namespace splatlas {

inline void must(const OFCondition& status, const char* what) {
  if (status.bad()) throw std::runtime_error(fmt::format("{}: {}", what, status.text()));
}

inline void put(DcmItem& item, const DcmTagKey& key, const std::string& text) {
  DcmTag tag(key);
  if (tag.isPrivate()) tag.setVR(EVR_LO);
  if (tag.getEVR() == EVR_xs) tag.setVR(EVR_US);  // as the pixels
  must(item.putAndInsertString(tag, text.c_str()), "put");
}

inline DcmItem& item_of(DcmItem& parent, const DcmTagKey& sequence, long number = -2) {
  DcmItem* item = nullptr;
  must(parent.findOrCreateSequenceItem(sequence, item, number), "item");
  return *item;
}

inline std::string joined(const auto& numbers) {
  std::string text;
  for (const auto& number : numbers) text += (text.empty() ? "" : "\\") + fmt::format("{:.10g}", number);
  return text;
}

inline void put_pixel_format(DcmItem& item, int columns, int rows, int allocated, int stored, int high,
                             bool is_signed) {
  put(item, DCM_SamplesPerPixel, "1");
  put(item, DCM_PhotometricInterpretation, "MONOCHROME2");
  put(item, DCM_Rows, std::to_string(rows));
  put(item, DCM_Columns, std::to_string(columns));
  put(item, DCM_BitsAllocated, std::to_string(allocated));
  put(item, DCM_BitsStored, std::to_string(stored));
  put(item, DCM_HighBit, std::to_string(high));
  put(item, DCM_PixelRepresentation, is_signed ? "1" : "0");
}

inline void put_series(DcmItem& item, const std::string& class_uid, const std::string& modality) {
  static int instance = 0;
  put(item, DCM_SOPClassUID, class_uid);
  put(item, DCM_SOPInstanceUID, "1.2.3.4." + std::to_string(++instance));
  put(item, DCM_Modality, modality);
  put(item, DCM_SeriesInstanceUID, "1.2.3");
  put(item, DCM_SeriesNumber, "7");
}

inline void save(DcmFileFormat& file, const std::filesystem::path& path, E_TransferSyntax syntax) {
  must(file.saveFile(path.c_str(), syntax), "save");
}

inline DcmItem& add_plane(DcmItem& groups, const Vec3& position) {
  put(item_of(groups, DCM_PlanePositionSequence), DCM_ImagePositionPatient, joined(position));
  return groups;
}

inline void add_shared_planes(DcmItem& shared, const std::string& spacing, double slice_spacing,
                              const std::array<double, 6>& axes = {1, 0, 0, 0, 1, 0}) {
  put(item_of(shared, DCM_PlaneOrientationSequence), DCM_ImageOrientationPatient, joined(axes));
  DcmItem& measures = item_of(shared, DCM_PixelMeasuresSequence);
  put(measures, DCM_PixelSpacing, spacing);
  if (slice_spacing > 0) put(measures, DCM_SpacingBetweenSlices, fmt::format("{}", slice_spacing));
}

}  // namespace splatlas
