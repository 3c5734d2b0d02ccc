#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include <fmt/ranges.h>

#include "format/content/voxel_type.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/dicom/decode/decode_frame.h"
#include "preprocess/import/images/dicom/dicom_frame.h"
#include "preprocess/import/images/dicom/dicom_item.h"
#include "preprocess/import/images/dicom/read_segmentation.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

template <typename T>
bool holds(double min, double max) {
  return min >= static_cast<double>(std::numeric_limits<T>::min()) &&
         max <= static_cast<double>(std::numeric_limits<T>::max());
}

/// The type for all values that the bits of the frames can have: kInt32 if only the pixels can tell.
VoxelType widest_type(const SlicedStack& stack) {
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const auto& slice : stack.slices) {
    const DicomFrame& frame = *slice.front();
    if (std::abs(frame.slope - 1) > 0 || std::abs(std::trunc(frame.intercept) - frame.intercept) > 0)
      return VoxelType::kFloat32;
    min = std::min(min, static_cast<double>(frame.pixels.min()) + frame.intercept);
    max = std::max(max, static_cast<double>(frame.pixels.max()) + frame.intercept);
  }
  if (holds<std::int16_t>(min, max)) return VoxelType::kInt16;
  if (holds<std::uint16_t>(min, max)) return VoxelType::kUInt16;
  return holds<std::int32_t>(min, max) ? VoxelType::kInt32 : VoxelType::kFloat32;
}

/// Makes a buffer of another type. In place: no value of T is longer than 32 bits.
template <typename T>
void convert(VoxelBuffer& voxels, VoxelType type) {
  const std::size_t count = voxels.bytes.size() / sizeof(std::int32_t);
  for (std::size_t v = 0; v < count; ++v) {
    std::int32_t value = 0;
    std::memcpy(&value, &voxels.bytes[v * sizeof(value)], sizeof(value));
    const auto converted = static_cast<T>(value);
    std::memcpy(&voxels.bytes[v * sizeof(T)], &converted, sizeof(T));
  }
  voxels.bytes.resize(count * sizeof(T));
  voxels.bytes.shrink_to_fit();
  voxels.type = type;
}

void narrow(VoxelBuffer& voxels) {
  const std::int32_t* const values = voxels.as<std::int32_t>();
  const auto [least, greatest] = std::minmax_element(values, values + voxels.bytes.size() / sizeof(*values));
  const double min = *least, max = *greatest;
  if (holds<std::int16_t>(min, max)) return convert<std::int16_t>(voxels, VoxelType::kInt16);
  if (holds<std::uint16_t>(min, max)) return convert<std::uint16_t>(voxels, VoxelType::kUInt16);
  convert<float>(voxels, VoxelType::kFloat32);
}

void note_kinds(const SlicedStack& stack, Notes& notes) {
  for (const auto& slice : stack.slices) {
    for (std::size_t n = 1; n < slice.size(); ++n) note_duplicate(*slice[n], notes);
  }
  const DicomFrame& first = *stack.slices.front().front();
  if (first.is_mosaic) notes.add("mosaic", position_text(first.position));
  if (first.is_inverted) notes.add("inverted-image", first.modality);
}

/// Decodes the first frame of each slice and applies its slope and intercept. int16 or uint16 if they hold
/// all values exactly: every slope is 1 and every intercept is whole. Else float32. Padding keeps its value.
/// Voxels between slices are interpolated, and rounded for integers. Further frames of a slice are ignored
/// and noted. kFailed for damaged files. Cost: one pass; memory for the volume, and twice as much for values
/// of more than 16 bits. One thread at a time.
Result<VoxelBuffer> read_volume(const SlicedStack& stack, Notes& notes) {
  VoxelBuffer voxels{widest_type(stack), {}};
  const auto plane = static_cast<std::size_t>(stack.grid.size[0] * stack.grid.size[1]);
  const auto count = static_cast<std::size_t>(stack.grid.size[2]);
  voxels.bytes.resize(plane * count * bytes_of(voxels.type));
  FrameDecoder decoder;
  std::vector<double> below, above(plane);
  std::size_t decoded = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto place = static_cast<double>(k);
    while (decoded == 0 || (decoded < stack.slices.size() && stack.places[decoded - 1] < place)) {
      const DicomFrame& frame = *stack.slices[decoded++].front();
      SPLATLAS_ASSIGN_OR_RETURN(const auto stored, decoder.decode(frame));
      below = above;
      for (std::size_t v = 0; v < plane; ++v)
        above[v] = static_cast<double>(stored[v]) * frame.slope + frame.intercept;
    }
    const double end = stack.places[decoded - 1];
    const double part =
        end > place ? (place - stack.places[decoded - 2]) / (end - stack.places[decoded - 2]) : 1;
    visit_voxel_type(voxels.type, [&]<typename T>(T) {
      T* const values = voxels.as<T>() + k * plane;
      for (std::size_t v = 0; v < plane; ++v) {
        const double value = part < 1 ? below[v] + part * (above[v] - below[v]) : above[v];
        values[v] = static_cast<T>(std::is_integral_v<T> ? std::floor(value + 1.0 / 2) : value);
      }
    });
  }
  if (voxels.type == VoxelType::kInt32) narrow(voxels);
  note_kinds(stack, notes);
  return voxels;
}

using Stacks = std::vector<FrameStack>;

/// To compare only: a UID may hold a date.
std::size_t hash_of(const std::string& frame_of_reference) {
  return frame_of_reference.empty() ? 0 : std::hash<std::string>{}(frame_of_reference);
}

const std::string& uid_of(const FrameStack& stack) {
  return stack.frames.front()->series_uid;
}

std::string list_of(const Stacks& stacks) {
  constexpr std::size_t kMaxListed = 50;
  std::string text = fmt::format("holds {} series; choose one with --series N", stacks.size());
  std::vector<std::string> texts;
  std::set<std::string> frames;
  for (const FrameStack& stack : stacks) {
    texts.push_back(description(stack));
    frames.insert(stack.frames.front()->frame_of_reference);
  }
  for (std::size_t n = 0; n < std::min(stacks.size(), kMaxListed); ++n) {
    text += fmt::format("{} {}: {}", n == 0 ? ":" : ";", n + 1, texts[n]);
    if (std::ranges::count(texts, texts[n]) == 1) continue;
    const DicomFrame& first = *stacks[n].frames.front();
    text += fmt::format(", number {}, normal {}, frame of reference {} of {}, {} at {}", first.series_number,
                        position_text(normal_of(first)),
                        std::distance(frames.begin(), frames.find(first.frame_of_reference)) + 1,
                        frames.size(), first.file.filename().string(), position_text(first.position));
  }
  if (stacks.size() > kMaxListed) text += fmt::format("; and {} more", stacks.size() - kMaxListed);
  return text;
}

/// The stacks that are wanted, segmentations or images; all of them if there are none.
Stacks wanted_stacks(Stacks stacks, bool segmentations) {
  const auto is_other = [&](const FrameStack& stack) {
    return stack.frames.front()->is_segmentation != segmentations;
  };
  if (!std::ranges::all_of(stacks, is_other)) std::erase_if(stacks, is_other);
  return stacks;
}

/// kUsage if labels are wanted of several segmentations.
Result<void> check_one_segmentation(const Stacks& stacks, const std::vector<ContourFile>& contours,
                                    const std::filesystem::path& path) {
  std::set<std::string> files;
  for (const ContourFile& contour : contours) files.insert(contour.file.string());
  for (const FrameStack& stack : stacks) {
    if (stack.frames.front()->is_segmentation) files.insert(stack.frames.front()->file.string());
  }
  if (files.size() < 2) return {};
  return fail(ErrorCode::kUsage, "{}: holds {} segmentations; give the file of one: {}", path.string(),
              files.size(), fmt::join(files, ", "));
}

/// The index of the stack that the user means.
Result<std::size_t> chosen_stack(const Stacks& stacks, const std::string& series,
                                 const std::filesystem::path& path) {
  if (series.empty()) {
    if (stacks.size() == 1) return 0;
    return fail(ErrorCode::kUsage, "{}: {}", path.string(), list_of(stacks));
  }
  if (const auto number = parse_number<std::size_t>(series)) {
    if (*number >= 1 && *number <= stacks.size()) return *number - 1;
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
  for (const DicomFault& fault : faults) {
    if (stacks == 0 || fault.series_uid.empty() || fault.series_uid == series_uid)
      return fail(ErrorCode::kFailed, fault.message);
  }
  for (std::size_t n = 0; n < faults.size(); ++n)
    notes.add("unusable-images", fmt::format("image {}", n + 1));
  return {};
}

/// The contours on the given grid, or on that of the only image series in their frame of reference.
Result<SourceImage> import_contours(const ContourFile& contours, const Stacks& stacks,
                                    std::optional<Grid> grid) {
  const auto is_same_frame = [&](const FrameStack& stack) {
    return stack.frames.front()->frame_of_reference == contours.frame_of_reference;
  };
  if (!grid && std::ranges::count_if(stacks, is_same_frame) == 1) {
    SPLATLAS_ASSIGN_OR_RETURN(
        const SlicedStack sliced,
        slice_stack(*std::ranges::find_if(stacks, is_same_frame), SliceGaps::kMissing, contours.file));
    grid = sliced.grid;
  }
  SPLATLAS_ASSIGN_OR_RETURN(SourceImage image, read_contours(contours.file, grid));
  image.frame_of_reference = hash_of(contours.frame_of_reference);
  return image;
}

/// True if a file, or one of a folder, is of a kind.
bool any_file(const std::filesystem::path& file_or_folder, bool (*is_it)(const std::filesystem::path&)) {
  constexpr std::size_t kMaxFiles = 4096;
  std::error_code ignored;
  std::vector<std::filesystem::path> files = regular_files_of(file_or_folder, ignored);
  files.resize(std::min(files.size(), kMaxFiles));
  return std::ranges::any_of(files, is_it);
}

}  // namespace

bool is_dicom(const std::filesystem::path& file_or_folder) {
  return any_file(file_or_folder, begins_as_dicom);
}

bool is_contours(const std::filesystem::path& file_or_folder) {
  return any_file(file_or_folder, [](const std::filesystem::path& file) {
    return begins_as_dicom(file) &&
           first_bytes(file, kHeadBytes).find(UID_RTStructureSetStorage) != std::string::npos;
  });
}

Result<SourceImage> import_dicom(const std::filesystem::path& file_or_folder, const ImageOptions& options) {
  prepare_dcmtk();
  SPLATLAS_ASSIGN_OR_RETURN(const DicomFrames found, read_frames(file_or_folder));
  const Stacks stacks = wanted_stacks(group_frames(found.frames), options.labels);
  Notes notes;
  if (options.labels) {
    SPLATLAS_RETURN_IF_ERROR(check_one_segmentation(stacks, found.contours, file_or_folder));
    if (!found.contours.empty()) return import_contours(found.contours.front(), stacks, options.grid);
  }
  if (stacks.empty()) {
    if (!found.contours.empty())
      return bad_file(file_or_folder, "holds contours (RTSTRUCT), which are structures; give it as --labels");
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
  image.frame_of_reference = hash_of(first.frame_of_reference);
  image.notes.add(notes);
  return image;
}

void load_dicom_dictionary() {
  prepare_dcmtk();
  static_cast<void>(dcmDataDict.rdlock());
  dcmDataDict.rdunlock();
}

}  // namespace splatlas
