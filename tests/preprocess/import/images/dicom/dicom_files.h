// DICOM files of tests, written by DCMTK. Functions throw std::runtime_error if a file cannot be written.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "format/content/grid.h"

namespace splatlas {

struct DicomTag {
  std::uint16_t group = 0, element = 0;
};
using DicomTexts = std::vector<std::pair<DicomTag, std::string>>;

inline constexpr const char* kCtClass = "1.2.840.10008.5.1.4.1.1.2";
inline constexpr const char* kReportClass = "1.2.840.10008.5.1.4.1.1.88.11";

/// One slice of 8 x 6 pixels.
struct TestSlice {
  static constexpr int kColumns = 8, kRows = 6;
  static constexpr std::size_t kPixels = std::size_t{kColumns} * kRows;

  Vec3 position{};
  std::array<double, 6> axes{1, 0, 0, 0, 1, 0};
  std::array<double, 2> spacing{0.5, 0.25};  // as in the file: between rows, between columns
  int bits_allocated = 16, bits_stored = 16, high_bit = 15;
  bool is_signed = true;
  std::vector<std::uint16_t> stored;  // one for each pixel; below 256 if 8 bits are allocated
  DicomTexts texts;                   // set at last
  std::vector<DicomTag> erased;
  std::string class_uid = kCtClass;
};

/// Gives each row one small value: DCMTK's JPEG-LS encoder overruns its buffer if pixels get no smaller.
inline void make_compressible(TestSlice& slice) {
  for (std::size_t v = 0; v < slice.stored.size(); ++v)
    slice.stored[v] = static_cast<std::uint16_t>(3 + v / TestSlice::kColumns);
}

enum class TestCoding {
  kExplicit,
  kImplicit,
  kBigEndian,
  kDeflated,
  kRunLengths,
  kJpegLossless,
  kJpegLs,
  kJpeg2000,
};

void write_slice(const TestSlice& slice, const std::filesystem::path& path,
                 TestCoding coding = TestCoding::kExplicit);

/// A frame of an enhanced MR image of 8 x 6 pixels of 0.5 mm.
struct TestFrame {
  Vec3 position{};
  double slope = 1, intercept = 0;
  std::string type = "ORIGINAL\\PRIMARY\\M";
  std::vector<std::uint16_t> stored;
};
void write_enhanced(const std::vector<TestFrame>& frames, const std::filesystem::path& path);

struct TestSegment {
  int number = 1;
  std::string label;
  std::array<std::uint16_t, 3> lab{};  // none if 0
  std::string scheme, code, modifier;
};

struct TestSegmentFrame {
  int segment = 1;  // 0 in a label map
  double z = 0;     // mm along the normal
  std::vector<std::uint16_t> values;
};

/// A segmentation of 7 x 5 pixels of 1 mm: frames of bits end within a byte. Texts hold the word PLANTED.
struct TestSegmentation {
  static constexpr int kColumns = 7, kRows = 5;
  static constexpr std::size_t kPixels = std::size_t{kColumns} * kRows;

  std::string type = "BINARY";
  int bits = 1;
  double slice_spacing = 0;  // not written if 0
  std::array<double, 6> axes{1, 0, 0, 0, 1, 0};
  Vec3 origin{}, normal{0, 0, 1};
  std::vector<TestSegment> segments;
  std::vector<TestSegmentFrame> frames;
  DicomTexts texts;
};
void write_segmentation(const TestSegmentation& segmentation, const std::filesystem::path& path);

struct TestRegion {
  std::string name;
  std::vector<std::vector<Vec3>> contours;  ///< closed ones, or single points
};
/// A file of contours (RTSTRUCT) in #0a141e. The first region has number 3.
void write_contours(const std::vector<TestRegion>& regions, const std::filesystem::path& path,
                    const std::string& frame_of_reference = "");

/// Fills every text and UID attribute of the dictionary that the file lacks, and a private group, with words
/// that hold PLANTED, and UIDs from 9.8.7.6. Returns their number.
std::size_t plant_identifiers(const std::filesystem::path& path);

/// A JPEG 2000 codestream, lossless.
[[nodiscard]] std::string encoded_jpeg_2000(const std::vector<std::int32_t>& values, int columns, int rows,
                                            int bits, bool is_signed);

}  // namespace splatlas
