#include "preprocess/import/images/dicom/read_frames.h"

#include <algorithm>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/images/dicom/frame_attributes.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/isolation/run_isolated.h"

namespace splatlas {
namespace {

constexpr int kMaxDepth = 16;

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
    const std::string class_uid = text_in(*(*format)->getMetaInfo(), DCM_MediaStorageSOPClassUID);
    series_uid_ = text_in(dataset, DCM_SeriesInstanceUID);
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

Result<std::vector<std::filesystem::path>> files_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  using Iterator = std::filesystem::recursive_directory_iterator;
  for (Iterator entry(folder, error); !error && entry != Iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
    if (entry.depth() >= kMaxDepth)
      return bad_file(folder, "has folders more than {} deep; give the folder of the series", kMaxDepth);
  }
  if (error) return bad_file(folder, "cannot be listed ({})", error.message());
  std::ranges::sort(files);
  return files;
}

}  // namespace

Result<DicomFrames> read_frames(const std::filesystem::path& file_or_folder) {
  DicomFrames found;
  std::error_code ignored;
  if (!std::filesystem::is_directory(file_or_folder, ignored)) {
    FramesOfFile(file_or_folder, true, found).add();
    return found;
  }
  SPLATLAS_ASSIGN_OR_RETURN(const auto files, files_below(file_or_folder));
  for (const std::filesystem::path& file : files) FramesOfFile(file, false, found).add();
  return found;
}

}  // namespace splatlas
