// Pixels of DICOM files: codings, stored bits, value scales, and damage.
#include <random>

#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"
#include "tests/support/file_bytes.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

constexpr std::array kCodings{TestCoding::kExplicit, TestCoding::kImplicit,   TestCoding::kBigEndian,
                              TestCoding::kDeflated, TestCoding::kRunLengths, TestCoding::kJpegLossless,
                              TestCoding::kJpegLs,   TestCoding::kJpeg2000};

TEST_F(ImportDicom, EveryCodingHasTheSameValues) {
  std::mt19937 random(5);
  for (const bool is_signed : {false, true}) {
    for (const TestCoding coding : kCodings) {
      SCOPED_TRACE(static_cast<int>(coding));
      std::vector<std::uint16_t> all;
      for (int k = 0; k < 3; ++k) {
        TestSlice slice = axial(k);
        slice.is_signed = is_signed;
        for (std::uint16_t& value : slice.stored) value = static_cast<std::uint16_t>(random());
        slice.stored[0] = 0x8000;
        slice.stored[1] = 0x7fff;
        if (coding == TestCoding::kJpegLs) make_compressible(slice);
        all.insert(all.end(), slice.stored.begin(), slice.stored.end());
        write_slice(slice, file(fmt::format("slice{}", k)), coding);
      }
      const SourceImage image = imported();
      ASSERT_EQ(image.voxels.type, is_signed ? VoxelType::kInt16 : VoxelType::kUInt16);
      ASSERT_EQ(image.voxels.bytes.size(), 2 * all.size());
      for (std::size_t v = 0; v < all.size(); ++v) ASSERT_EQ(image.voxels.as<std::uint16_t>()[v], all[v]);
    }
  }
}

TEST_F(ImportDicom, OnlyTheStoredBitsCount) {
  // 12 bits at every place of 16, between bits of dirt.
  for (const bool is_signed : {false, true}) {
    for (const int high_bit : {11, 13, 15}) {
      TestSlice slice = axial(0);
      slice.bits_stored = 12;
      slice.high_bit = high_bit;
      slice.is_signed = is_signed;
      const int low_bit = high_bit - 11;
      const auto expected = [&](int v) { return is_signed ? 83 * v - 2048 : 83 * v; };
      for (int v = 0; v < 48; ++v) {
        const unsigned dirt = v % 2 == 0 ? ~(0xfffu << low_bit) : 0u;
        const unsigned bits = (static_cast<unsigned>(expected(v)) & 0xfffu) << low_bit;
        slice.stored[static_cast<std::size_t>(v)] = static_cast<std::uint16_t>(bits | dirt);
      }
      write_slice(slice, file("a"));
      const SourceImage image = imported();
      ASSERT_EQ(image.voxels.type, VoxelType::kInt16);
      for (int v = 0; v < 48; ++v) ASSERT_EQ(image.voxels.as<std::int16_t>()[v], expected(v));
    }
  }
}

TEST_F(ImportDicom, SlopesAreThoseOfEachSlice) {
  const std::array<std::string, 3> slopes{"0.5", "2", "1e1"}, intercepts{"1", "-0.25", "0"};
  for (int k = 0; k < 3; ++k) {
    TestSlice slice = axial(k);
    const auto n = static_cast<std::size_t>(k);
    slice.texts = {{kSlopeTag, slopes[n]}, {kInterceptTag, intercepts[n]}};
    write_slice(slice, file(fmt::format("slice{}", k)));
  }
  const SourceImage image = imported();
  ASSERT_EQ(image.voxels.type, VoxelType::kFloat32);
  const float* const values = image.voxels.as<float>();
  for (std::size_t v = 0; v < TestSlice::kPixels; ++v) {
    const auto x = static_cast<float>(v);
    ASSERT_EQ(values[v], 0.5f * x + 1);
    ASSERT_EQ(values[TestSlice::kPixels + v], 2 * (100 + x) - 0.25f);
    ASSERT_EQ(values[2 * TestSlice::kPixels + v], 10 * (200 + x));
  }
}

TEST_F(ImportDicom, WholeValuesStayExact) {
  const auto type_of = [&](bool is_signed, const std::string& intercept, std::uint16_t last) {
    TestSlice slice = axial(0);
    slice.is_signed = is_signed;
    slice.stored.back() = last;
    slice.texts = {{kInterceptTag, intercept}};
    write_slice(slice, file("a"));
    const SourceImage image = imported();
    const double offset = std::stod(intercept);
    visit_voxel_type(image.voxels.type, [&]<typename T>(T) {
      const T* const values = image.voxels.as<T>();
      EXPECT_EQ(static_cast<double>(values[3]), 3 + offset);
      const double expected = is_signed ? static_cast<std::int16_t>(last) : last;
      EXPECT_EQ(static_cast<double>(values[TestSlice::kPixels - 1]), expected + offset);
    });
    return image.voxels.type;
  };
  EXPECT_EQ(type_of(true, "0", 0x8000), VoxelType::kInt16);
  EXPECT_EQ(type_of(true, "-1024", 100), VoxelType::kInt16);
  EXPECT_EQ(type_of(false, "-1024", 4095), VoxelType::kInt16);
  EXPECT_EQ(type_of(false, "0", 65535), VoxelType::kUInt16);
  EXPECT_EQ(type_of(true, "40000", 100), VoxelType::kUInt16);
  EXPECT_EQ(type_of(false, "1", 65534), VoxelType::kUInt16);
  EXPECT_EQ(type_of(false, "1", 65535), VoxelType::kFloat32);
  EXPECT_EQ(type_of(false, "-1024", 65535), VoxelType::kFloat32);
  EXPECT_EQ(type_of(true, "-1024", 0x8000), VoxelType::kFloat32);
  EXPECT_EQ(type_of(true, "0.5", 100), VoxelType::kFloat32);
}

TEST_F(ImportDicom, EveryCutFileIsRefused) {
  for (const TestCoding coding : {TestCoding::kExplicit, TestCoding::kImplicit, TestCoding::kRunLengths,
                                  TestCoding::kJpegLossless, TestCoding::kJpegLs, TestCoding::kJpeg2000}) {
    for (int k = 0; k < 2; ++k) write_slice(axial(k), file(fmt::format("slice{}.dcm", k)), coding);
    const std::string whole = read_bytes(file("slice1.dcm"));
    expect_ramps(imported(), 2);
    for (std::size_t length = 0; length < whole.size(); length += kEveryNth) {
      write_bytes(file("slice1.dcm"), std::string_view(whole).substr(0, length));
      const Result<SourceImage> image = import();
      ASSERT_FALSE(image) << "cut to " << length << " of " << whole.size();
      ASSERT_EQ(image.error().code, ErrorCode::kFailed);
      ASSERT_THAT(image.error().message, HasSubstr("slice1.dcm: "));
      ASSERT_THAT(image.error().message, Not(HasSubstr("\n")));
    }
  }
}

struct Refusal {
  DicomTexts texts;
  std::vector<DicomTag> erased;
  std::string message;
};

TEST_F(ImportDicom, RefusesWhatIsNoVolume) {
  const std::vector<Refusal> refusals{
      {{}, {{0x0020, 0x0032}}, "has no ImagePositionPatient"},
      {{}, {{0x0020, 0x0037}}, "has no ImageOrientationPatient"},
      {{}, {{0x0028, 0x0030}}, "has no PixelSpacing"},
      {{}, {{0x0028, 0x0010}}, "has no pixels (Rows is missing)"},
      {{}, {{0x0028, 0x0011}}, "has 6 rows and -1 columns"},
      {{}, {{0x0028, 0x0100}}, "does not say how its pixels are stored"},
      {{}, {{0x0028, 0x0101}}, "does not say how its pixels are stored"},
      {{}, {{0x0028, 0x0102}}, "does not say how its pixels are stored"},
      {{}, {{0x0028, 0x0103}}, "does not say how its pixels are stored"},
      {{}, {{0x7fe0, 0x0010}}, "has no pixels"},
      {{{{0x0020, 0x0032}, "1\\2"}}, {}, "has no ImagePositionPatient"},
      {{{{0x0020, 0x0032}, "1\\2\\x"}}, {}, "has no ImagePositionPatient"},
      {{{{0x0020, 0x0032}, "1\\2\\1e300"}}, {}, "has a position that cannot be"},
      {{{{0x0020, 0x0037}, "1\\0\\0\\0.1\\1\\0"}}, {}, "has an orientation that is no rotation"},
      {{{{0x0020, 0x0037}, "0\\0\\0\\0\\0\\0"}}, {}, "has an orientation that is no rotation"},
      {{{{0x0028, 0x0030}, "0\\1"}}, {}, "has PixelSpacing 0 and 1 mm"},
      {{{{0x0028, 0x0002}, "3"}}, {}, "is a colour image"},
      {{{{0x0028, 0x0004}, "PALETTE COLOR"}}, {}, "is a colour image"},
      {{{{0x0028, 0x0100}, "12"}}, {}, "has BitsAllocated 12"},
      {{{{0x0028, 0x0101}, "17"}}, {}, "has BitsStored 17 of BitsAllocated 16"},
      {{{{0x0028, 0x0101}, "0"}}, {}, "has BitsStored 0"},
      {{{{0x0028, 0x0102}, "14"}}, {}, "has HighBit 14, which contradicts BitsStored 16"},
      {{{{0x0028, 0x0102}, "16"}}, {}, "has HighBit 16"},
      {{{{0x0028, 0x0008}, "5"}}, {}, "has 5 frames without a position for each"},
      {{{{0x0028, 0x0008}, "0"}}, {}, "has NumberOfFrames 0"},
      {{{{0x0028, 0x0010}, "7"}}, {}, "has 96 bytes of pixels instead of 112"},
      {{{{0x0048, 0x0006}, "600"}}, {}, "is an image of a microscope slide"},
      {{{kSlopeTag, "0"}}, {}, "has a value scale that cannot be"},
      {{{kSlopeTag, "x"}}, {}, "has a value scale that cannot be"},
  };
  for (const Refusal& refusal : refusals) {
    TestSlice slice = axial(0);
    slice.texts = refusal.texts;
    slice.erased = refusal.erased;
    write_slice(slice, file("a"));
    EXPECT_THAT(import(), FailsWith(ErrorCode::kFailed, HasSubstr("a: " + refusal.message)));
  }
}

}  // namespace
}  // namespace splatlas
