#include "preprocess/import/images/dicom/import_dicom.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/images/dicom/read_frames.h"
#include "preprocess/import/images/dicom/read_segmentation.h"
#include "preprocess/import/images/dicom/read_volume.h"
#include "preprocess/import/images/dicom/stack_frames.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

using Stacks = std::vector<FrameStack>;

const std::string& uid_of(const FrameStack& stack) {
  return stack.frames.front()->series_uid;
}

std::string list_of(const Stacks& stacks) {
  constexpr std::size_t kMaxListed = 50;
  std::string text = fmt::format("holds {} series; choose one with --series N", stacks.size());
  for (std::size_t n = 0; n < std::min(stacks.size(), kMaxListed); ++n)
    text += fmt::format("{} {}: {}", n == 0 ? ":" : ";", n + 1, description(stacks[n]));
  if (stacks.size() > kMaxListed) text += fmt::format("; and {} more", stacks.size() - kMaxListed);
  return text;
}

/// The index of the stack that the user means.
Result<std::size_t> chosen_stack(const Stacks& stacks, const std::string& series,
                                 const std::filesystem::path& path) {
  if (series.empty()) {
    if (stacks.size() == 1) return 0;
    return fail(ErrorCode::kUsage, "{}: {}", path.string(), list_of(stacks));
  }
  std::size_t number = 0;
  const char* const end = series.data() + series.size();
  if (const auto parsed = std::from_chars(series.data(), end, number);
      parsed.ec == std::errc{} && parsed.ptr == end) {
    if (number >= 1 && number <= stacks.size()) return number - 1;
  } else {
    const auto first = std::ranges::find(stacks, series, uid_of);
    const auto count = std::ranges::count(stacks, series, uid_of);
    if (count == 1) return static_cast<std::size_t>(first - stacks.begin());
    if (count > 1) {
      return fail(ErrorCode::kUsage, "{}: series {} has {} volumes, so it needs a number; {}", path.string(),
                  series, count, list_of(stacks));
    }
  }
  return fail(ErrorCode::kUsage, "{}: has no series {}; it {}", path.string(), series, list_of(stacks));
}

/// Files that look like images but are none concern a series they belong to. Others are noted.
Result<void> check_faults(const std::vector<DicomFault>& faults, const std::string& series_uid,
                          std::size_t stacks, Notes& notes) {
  static const NoteKind kUnusable{"unusable-images",
                                  "image of other series cannot be a volume and is ignored",
                                  "images of other series cannot be volumes and are ignored"};
  for (const DicomFault& fault : faults) {
    if (stacks == 0 || fault.series_uid.empty() || fault.series_uid == series_uid)
      return fail(ErrorCode::kFailed, fault.message);
  }
  for (std::size_t n = 0; n < faults.size(); ++n) notes.add(kUnusable, fmt::format("image {}", n + 1));
  return {};
}

}  // namespace

bool is_dicom(const std::filesystem::path& file_or_folder) {
  constexpr int kMaxDepth = 16, kMaxFiles = 4096;
  if (begins_as_dicom(file_or_folder)) return true;
  std::error_code error;
  if (!std::filesystem::is_directory(file_or_folder, error)) return false;
  using Iterator = std::filesystem::recursive_directory_iterator;
  constexpr auto kOptions = std::filesystem::directory_options::skip_permission_denied;
  int files = 0;
  for (Iterator entry(file_or_folder, kOptions, error); !error && entry != Iterator();
       entry.increment(error)) {
    if (entry.depth() >= kMaxDepth) entry.disable_recursion_pending();
    std::error_code ignored;
    if (!entry->is_regular_file(ignored)) continue;
    if (++files > kMaxFiles) return false;
    if (begins_as_dicom(entry->path())) return true;
  }
  return false;
}

Result<SourceImage> import_dicom(const std::filesystem::path& file_or_folder, const ImageOptions& options) {
  prepare_dcmtk();
  SPLATLAS_ASSIGN_OR_RETURN(const DicomFrames found, read_frames(file_or_folder));
  const Stacks stacks = group_frames(found.frames);
  Notes notes;
  if (stacks.empty()) {
    SPLATLAS_RETURN_IF_ERROR(check_faults(found.faults, "", 0, notes));
    return bad_file(file_or_folder, "holds no DICOM image; give the file or folder of a series");
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::size_t n, chosen_stack(stacks, options.series, file_or_folder));
  const FrameStack& stack = stacks[n];
  SPLATLAS_RETURN_IF_ERROR(check_faults(found.faults, uid_of(stack), stacks.size(), notes));
  const DicomFrame& first = *stack.frames.front();
  SourceImage image;
  if (first.is_segmentation) {
    SPLATLAS_ASSIGN_OR_RETURN(SlicedStack sliced, slice_stack(stack, SliceGaps::kEmpty, first.file));
    SPLATLAS_ASSIGN_OR_RETURN(image, read_segmentation(std::move(sliced), first.file));
  } else {
    SPLATLAS_ASSIGN_OR_RETURN(const SlicedStack sliced,
                              slice_stack(stack, SliceGaps::kMissing, file_or_folder));
    image.grid = sliced.grid;
    image.notes = sliced.notes;
    SPLATLAS_ASSIGN_OR_RETURN(image.voxels, read_volume(sliced, image.notes));
  }
  image.notes.add(notes);
  return image;
}

void load_dicom_dictionary() {
  prepare_dcmtk();
  static_cast<void>(dcmDataDict.rdlock());
  dcmDataDict.rdunlock();
}

}  // namespace splatlas
