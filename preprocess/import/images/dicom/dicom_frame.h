// Frames of DICOM files without their pixels, the header pass that reads them, and their stacks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/content/grid.h"
#include "format/result.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// Stored numbers of a frame.
struct PixelFormat {
  int rows = 0, columns = 0;
  int bits_allocated = 0, bits_stored = 0;
  int high_bit = 0;  ///< of the value; the bits above and below it may hold anything
  bool is_signed = false;

  friend bool operator==(const PixelFormat&, const PixelFormat&) = default;
  [[nodiscard]] std::int64_t min() const {
    return is_signed ? -(std::int64_t{1} << (bits_stored - 1)) : std::int64_t{0};
  }
  [[nodiscard]] std::int64_t max() const {
    return (std::int64_t{1} << (is_signed ? bits_stored - 1 : bits_stored)) - 1;
  }
};

/// Attributes that tell apart volumes of one series, in the order of trial.
enum class SplitKey {
  kEcho,
  kTime,
  kImageType,
  kAcquisition,
  kDiffusion,
  kTrigger,
};
inline constexpr std::size_t kSplitKeys = 6;

/// One frame of a file. All lengths are in LPS mm.
struct DicomFrame {
  std::filesystem::path file;
  std::uint32_t index = 0;  ///< in the file, from 0
  std::uint32_t frames_of_file = 1;
  PixelFormat pixels;
  Vec3 position{};                  ///< centre of the first pixel
  Vec3 row{}, column{};             ///< unit vectors along a row (i) and down a column (j)
  std::array<double, 2> spacing{};  ///< between pixels of a row, and of a column
  double slice_spacing = 0;         ///< as the file says; 0 if it does not
  double thickness = 0;             ///< 0 if unknown
  double slope = 1, intercept = 0;
  bool is_mosaic = false;    ///< holds many slices side by side
  bool is_inverted = false;  ///< MONOCHROME1: low values are shown bright
  bool is_segmentation = false;
  std::uint16_t segment = 0;                   ///< of segmentations; 0 if the pixels name it
  std::string series_uid, frame_of_reference;  ///< may hold a date: never passed on
  std::int64_t series_number = 0;
  std::string modality;                            ///< upper-case letters and digits, or "image"
  std::array<std::string, kSplitKeys> split_keys;  ///< to compare only
};

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
/// images are ignored: indices (DICOMDIR), reports, texts. kFailed if a folder cannot be listed. Cost: opens
/// each file once and reads no pixels. One thread at a time.
[[nodiscard]] Result<DicomFrames> read_frames(const std::filesystem::path& file_or_folder);

/// Frames of one volume, in the order of the files. They point into the list that was grouped.
struct FrameStack {
  std::vector<const DicomFrame*> frames;
  std::string part;  ///< of a series that was split: "echo 1 of 2"; else empty
};

/// Groups frames by series, frame of reference, size, orientation (within 1e-3) and pixel spacing (1e-4); a
/// segmentation file is a group. Where positions repeat or steps are uneven, splits a group by the first of
/// its kinds (SplitKey, then pairs of them) that leaves even stacks of two and more slices which interleave.
/// In order of series number and file.
[[nodiscard]] std::vector<FrameStack> group_frames(std::span<const DicomFrame> frames);

/// "CT 512x512x93, 3.2x3.2x1.5 mm", with the part. The number of slices counts positions.
[[nodiscard]] std::string description(const FrameStack& stack);

struct SlicedStack {
  Grid grid;           ///< LPS; a tilted stack has a sheared direction
  double step_mm = 1;  ///< along the normal
  std::vector<std::vector<const DicomFrame*>>
      slices;  ///< then all frames there, in the order of the files; one slice for each k of a segmentation
  std::vector<double> places;  ///< of an image's slices along k, ascending: 0, 1, 2, ... unless uneven
  Notes notes;
};

/// Slices of which some may be missing, or of which empty ones are left out (segmentations).
enum class SliceGaps { kMissing, kEmpty };

/// Orders a stack by position along the normal and derives the grid. Its step is the least one; in
/// segmentations it is SpacingBetweenSlices if all positions are multiples of it. A warning tells of missing
/// slices and uneven steps, with the tilt. kFailed, with `path` and position, for slices off the line.
/// Notes tilt: slices that are moved by more than 1e-3 of the step against the normal.
[[nodiscard]] Result<SlicedStack> slice_stack(const FrameStack& stack, SliceGaps gaps,
                                              const std::filesystem::path& path);

/// Row x column: where slices come to lie in a right-handed grid.
[[nodiscard]] Vec3 normal_of(const DicomFrame& frame);
/// "(0, 0, 12.5)", for messages.
[[nodiscard]] std::string position_text(const Vec3& position_lps_mm);
/// Notes a frame that is ignored for another one at its position.
void note_duplicate(const DicomFrame& frame, Notes& notes);

}  // namespace splatlas
