// The header pass over DICOM files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/result.h"
#include "preprocess/import/images/dicom/dicom_frame.h"

namespace splatlas {

/// A file that looks like an image but cannot be part of a volume.
struct DicomFault {
  std::string series_uid;  ///< empty if unknown
  std::string message;     ///< with the file's name
};

/// A file of contours (RTSTRUCT).
struct ContourFile {
  std::filesystem::path file;
  std::string frame_of_reference;
};

struct DicomFrames {
  std::vector<DicomFrame> frames;  ///< by file name, then in the order of the file
  std::vector<ContourFile> contours;
  std::vector<DicomFault> faults;
};

/// The header pass over a file, or over a folder and its subfolders. Files of a folder that are no DICOM
/// images are ignored: indices (DICOMDIR), reports, texts. kFailed if a folder cannot be listed, or is deeper
/// than 16 levels. Cost: opens each file once and reads no pixels. One thread at a time.
[[nodiscard]] Result<DicomFrames> read_frames(const std::filesystem::path& file_or_folder);

}  // namespace splatlas
