// Coded pixels that contradict the header, or end too soon, in files that are whole.
#include <cstring>

#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

constexpr std::array kCompressed{TestCoding::kRunLengths, TestCoding::kJpegLossless, TestCoding::kJpegLs,
                                 TestCoding::kJpeg2000};

class DamagedPixels : public ImportDicom {
 protected:
  /// A slice of values that do not compress to nothing.
  static TestSlice noisy(TestCoding coding = TestCoding::kExplicit) {
    TestSlice slice = axial(0);
    for (std::size_t v = 0; v < slice.stored.size(); ++v)
      slice.stored[v] = static_cast<std::uint16_t>((v * v * 7919 + 5) % 251);
    if (coding == TestCoding::kJpegLs) make_compressible(slice);
    return slice;
  }

  /// The file with an attribute of type US changed.
  static std::string with_number(std::string bytes, DicomTag tag, std::uint16_t value) {
    std::string start(10, '\0');
    const std::uint16_t length = 2;
    std::memcpy(start.data(), &tag.group, 2);
    std::memcpy(start.data() + 2, &tag.element, 2);
    std::memcpy(start.data() + 4, "US", 2);
    std::memcpy(start.data() + 6, &length, 2);
    const std::size_t at = bytes.find(start.substr(0, 8));
    EXPECT_NE(at, std::string::npos);
    std::memcpy(&bytes[at + 8], &value, 2);
    return bytes;
  }

  /// The file with its last fragment cut to a length.
  static std::string with_fragment(const std::string& bytes, std::size_t length) {
    const std::size_t at = last_fragment(bytes);
    const auto short_length = static_cast<std::uint32_t>(length);
    std::string cut = bytes.substr(0, at + 8 + length);
    std::memcpy(&cut[at + 4], &short_length, 4);
    return cut + bytes.substr(at + 8 + length_at(bytes, at));
  }
  static std::size_t last_fragment(const std::string& bytes) {
    return bytes.rfind(std::string("\xfe\xff\x00\xe0", 4));
  }
  static std::uint32_t length_at(const std::string& bytes, std::size_t fragment) {
    std::uint32_t length = 0;
    std::memcpy(&length, &bytes[fragment + 4], 4);
    return length;
  }
};

TEST_F(DamagedPixels, CutFragmentsAreRefused) {
  for (const TestCoding coding : kCompressed) {
    write_slice(noisy(coding), file("a"), coding);
    const SourceImage whole = imported();
    const std::string bytes = read_bytes(file("a"));
    const std::uint32_t length = length_at(bytes, last_fragment(bytes));
    ASSERT_GT(length, 40u);
    for (std::size_t kept = 0; kept < length; kept += 2) {
      write_bytes(file("a"), with_fragment(bytes, kept));
      const Result<SourceImage> cut = import();
      // Only bytes behind the last pixel may be missing.
      if (cut) {
        ASSERT_EQ(cut->voxels, whole.voxels);
        ASSERT_GE(kept + 4, length);
      }
    }
  }
}

TEST_F(DamagedPixels, CodedSizesMustBeThoseOfTheHeader) {
  for (const TestCoding coding : kCompressed) {
    SCOPED_TRACE(static_cast<int>(coding));
    write_slice(noisy(coding), file("a"), coding);
    const std::string bytes = read_bytes(file("a"));
    // Run lengths know no size: more rows find too few values, and fewer rows cannot be told.
    for (const std::uint16_t rows : std::array<std::uint16_t, 4>{3, 5, 7, 12}) {
      if (coding == TestCoding::kRunLengths && rows < TestSlice::kRows) continue;
      write_bytes(file("a"), with_number(bytes, {0x0028, 0x0010}, rows));
      EXPECT_THAT(import(), FailsWith(ErrorCode::kFailed, HasSubstr("a: has ")));
    }
    for (const std::uint16_t columns : std::array<std::uint16_t, 2>{9, 16}) {
      write_bytes(file("a"), with_number(bytes, {0x0028, 0x0011}, columns));
      EXPECT_THAT(import(), FailsWith(ErrorCode::kFailed, HasSubstr("a: has ")));
    }
    std::string narrow = with_number(bytes, {0x0028, 0x0100}, 8);
    narrow = with_number(with_number(narrow, {0x0028, 0x0101}, 8), {0x0028, 0x0102}, 7);
    write_bytes(file("a"), narrow);
    EXPECT_THAT(import(), FailsWith(ErrorCode::kFailed, HasSubstr("a: has ")));
  }
}

TEST_F(DamagedPixels, CodesOfEightBitsInSixteenAreReadOrRefused) {
  TestSlice slice = noisy();
  slice.bits_allocated = slice.bits_stored = 8;
  slice.high_bit = 7;
  slice.is_signed = false;
  for (const TestCoding coding : kCompressed) {
    write_slice(slice, file("a"), coding);
    const SourceImage expected = imported();
    for (std::size_t v = 0; v < TestSlice::kPixels; ++v)
      ASSERT_EQ(expected.voxels.as<std::int16_t>()[v], slice.stored[v]);
    write_bytes(file("a"), with_number(read_bytes(file("a")), {0x0028, 0x0100}, 16));
    const Result<SourceImage> wide = import();
    EXPECT_EQ(wide.has_value(), coding == TestCoding::kJpegLossless || coding == TestCoding::kJpeg2000);
    if (wide) {
      EXPECT_EQ(wide->voxels, expected.voxels);
    }
  }
}

}  // namespace
}  // namespace splatlas
