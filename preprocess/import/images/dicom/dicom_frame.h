// Geometry, value scale and kind of a frame of a DICOM file, without its pixels.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "format/content/grid.h"

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

}  // namespace splatlas
