#include "preprocess/import/images/import_image.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/preprocess/import/images/import_image_fixture.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

TEST_F(ImportImage, ReadsEveryFormatAlike) {
  for (const auto& [name, bytes] : {std::pair<const char*, std::string>{"a.mha", meta_image()},
                                    {"b.mha", compressed_meta_image()},
                                    {"a.nrrd", nrrd()},
                                    {"b.nrrd", compressed_nrrd()}}) {
    const Image image = imported(name, bytes);
    expect_raw_image(image);
    EXPECT_EQ(image.grid.origin_lps_mm, (Vec3{10, 20, 30}));
    EXPECT_EQ(image.grid.direction_lps, Matrix3({1, 0, 0, 0, 1, 0, 0, 0, 1}));
  }
}

TEST_F(ImportImage, TurnsNiftiFromRasToLps) {
  for (const auto& [name, bytes] :
       {std::pair<const char*, std::string>{"a.nii", nifti()}, {"a.nii.gz", deflated(nifti(), true)}}) {
    const Image image = imported(name, bytes);
    expect_raw_image(image);
    EXPECT_EQ(image.grid.origin_lps_mm, (Vec3{-10, -20, 30}));
    EXPECT_EQ(image.grid.direction_lps, Matrix3({-1, 0, 0, 0, -1, 0, 0, 0, 1}));
  }
}

TEST_F(ImportImage, ReadsGzipFilesOfSeveralMembers) {
  const std::string all = nifti();
  expect_raw_image(
      imported("a.nii.gz", deflated(all.substr(0, 400), true) + deflated(all.substr(400), true)));
}

TEST_F(ImportImage, TakesThePixelsOfTheFileThatIsNamed) {
  // The NIfTI library would read a.nii in place of a.nii.gz.
  std::string other = nifti();
  other.replace(352, 4, "abcd");
  write_bytes(folder_.file("a.nii"), other);
  const Image image = imported("a.nii.gz", deflated(nifti(), true));
  expect_raw_image(image);
  EXPECT_NE(import_image(folder_.file("a.nii"))->voxels, image.voxels);
  // And its geometry: ITK reads a qform alone.
  const auto with_qform = [](float x) {
    const std::string alone = with_number<std::int16_t>(nifti(), 254, 0);
    return with_number<float>(with_number<std::int16_t>(alone, 252, 1), 268, x);
  };
  write_bytes(folder_.file("a.nii"), with_qform(1));
  EXPECT_EQ(import_bytes("a.nii.gz", deflated(with_qform(2), true))->grid.origin_lps_mm[0], -2);
}

TEST_F(ImportImage, ReadsDetachedPixelsBesideTheHeader) {
  write_bytes(folder_.file("pixels.raw"), RawImage::payload());
  expect_raw_image(imported("a.mhd", meta_header("", "pixels.raw")));
  expect_raw_image(imported("a.nhdr", nrrd_header("raw", "data file: pixels.raw\n")));
}

TEST_F(ImportImage, ATwoDimensionalImageIsAVolumeOfOneSlice) {
  const std::string header =
      "NDims = 2\nDimSize = 3 2\nElementSpacing = 0.5 0.25\nElementType = MET_UCHAR\nElementDataFile = "
      "LOCAL\n";
  const Image image = imported("a.mha", header + "abcdef");
  EXPECT_EQ(image.grid.size, (Index3{3, 2, 1}));
  EXPECT_EQ(image.grid.spacing_mm, (Vec3{0.5, 0.25, 1}));
  EXPECT_EQ(image.grid.direction_lps, Matrix3({1, 0, 0, 0, 1, 0, 0, 0, 1}));
}

TEST_F(ImportImage, AFourthDimensionOfOneIsNoDimension) {
  const std::string four = with_number<std::int16_t>(nifti(), 40, 4);  // dim[4] is 1
  expect_raw_image(imported("a.nii", four));
}

TEST_F(ImportImage, RefusesEveryTruncation) {
  for (const auto& [name, bytes] : {std::pair<const char*, std::string>{"a.nii", nifti()},
                                    {"a.nii.gz", deflated(nifti(), true)},
                                    {"a.mha", meta_image()},
                                    {"b.mha", compressed_meta_image()},
                                    {"a.nrrd", nrrd()},
                                    {"b.nrrd", compressed_nrrd()}}) {
    ASSERT_TRUE(import_bytes(name, bytes)) << name;
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      ASSERT_FALSE(import_bytes(name, bytes.substr(0, length))) << name << " cut to " << length;
    }
  }
}

TEST_F(ImportImage, DamagedCompressedPixelsAreNoticed) {
  for (const auto& [name, bytes] : {std::pair<const char*, std::string>{"a.nii.gz", deflated(nifti(), true)},
                                    {"b.mha", compressed_meta_image()},
                                    {"b.nrrd", compressed_nrrd()}}) {
    std::string damaged = bytes;
    damaged[bytes.size() - 20] = static_cast<char>(damaged[bytes.size() - 20] ^ 0x10);
    EXPECT_FALSE(import_bytes(name, damaged)) << name;
  }
}

TEST_F(ImportImage, ReadsCompressedPixelsInEitherByteOrder) {
  std::string swapped = RawImage::payload();
  for (std::size_t at = 0; at < swapped.size(); at += 2) std::swap(swapped[at], swapped[at + 1]);
  std::string meta = meta_header("CompressedData = True\n"), nrrd_big = nrrd_header("gzip");
  meta.replace(meta.find("MSB = False"), 11, "MSB = True");
  nrrd_big.replace(nrrd_big.find("little"), 6, "big");
  for (const auto& [name, bytes] :
       {std::pair<const char*, std::string>{"a.mha", meta + deflated(swapped, false)},
        {"a.nrrd", nrrd_big + deflated(swapped, true)},
        {"b.nrrd", nrrd_header("gzip", "byte skip: 3\n") + deflated("abc" + RawImage::payload(), true)}}) {
    const Image image = value_or_throw(import_bytes(name, bytes));
    expect_raw_image(image);
  }
}

TEST_F(ImportImage, ReadsCompressedPixelsInEveryPlace) {
  const std::string pixels = RawImage::payload(), zlib = deflated(pixels, false);
  write_bytes(folder_.file("pixels.zraw"), zlib);
  write_bytes(folder_.file("pixels.raw.gz"), deflated(pixels, true));
  const std::string members = deflated(pixels.substr(0, 50), true) + deflated(pixels.substr(50), true);
  const std::string lower_order = "CompressedData = True\nElementByteOrderMSB = True\n";
  for (const auto& [name, bytes] :
       {std::pair<const char*, std::string>{"a.mhd", meta_header("CompressedData = True\n", "pixels.zraw")},
        {"a.nhdr", nrrd_header("gzip", "data file: pixels.raw.gz\n")},
        {"members.nrrd", nrrd_header("gzip") + members},
        {"surplus.mha", meta_header("CompressedData = True\n") + zlib + "abc"},
        {"wrong.mha", meta_header("CompressedData = True\nCompressedDataSize = 7\n") + zlib},
        {"order.mha", meta_header(lower_order) + zlib}}) {
    const Image image = value_or_throw(import_bytes(name, bytes));
    expect_raw_image(image);
  }
}

TEST_F(ImportImage, RefusesTextPixelsOfAnotherNumber) {
  std::string pixels;
  for (const int value : RawImage::voxels()) pixels += fmt::format("{} ", value);
  const Image whole = value_or_throw(import_bytes("a.nrrd", nrrd_header("ascii") + pixels));
  expect_raw_image(whole);
  for (const std::string& fewer : {pixels.substr(0, pixels.size() - 4), std::string(200, '\n') + "1 2 3"}) {
    const Result<Image> image = import_bytes("a.nrrd", nrrd_header("ascii") + fewer);
    ASSERT_FALSE(image);
    EXPECT_THAT(image.error().message,
                testing::AllOf(HasSubstr("a.nrrd: "), HasSubstr("sizes, type and encoding"),
                               testing::Not(HasSubstr("[nrrd]")), testing::Not(HasSubstr("\n"))));
  }
}

TEST_F(ImportImage, ReadsShearedAxesOfNrrdFiles) {
  const Image image = imported("a.nrrd", replaced(nrrd(), "(1,0,0) (0,2,0)", "(1,0,0) (1.9,0.3,0)"));
  EXPECT_NEAR(reference_length_mm(image.grid), std::cbrt(1 * 0.3 * 3), 1e-12);
}

TEST_F(ImportImage, RefusesImpossibleGeometry) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float spacing : {0.f, nan, inf}) {
    refuses("a.nii", with_number(nifti(), 84, spacing), "spacing");
  }
  refuses("a.nii", with_number(nifti(), 280, nan), "orientation");  // sform: ITK would abort
  refuses("a.nii", with_number(nifti(), 256, inf), "orientation");  // qform
  refuses("a.nii", with_number(nifti(), 116, nan), "scl_inter");
  expect_raw_image(imported("a.nii", with_number(nifti(), 112, nan)));
  for (const char* spacing : {"1 2 0", "1 2 -3", "1 2 nan", "1 2", "1 2 3 4", "a b c"}) {
    const std::string header = replaced(meta_header(), "= 1 2 3", fmt::format("= {}", spacing));
    refuses("a.mha", header + RawImage::payload(), "ElementSpacing");
  }
  refuses("a.nrrd", replaced(nrrd(), "(0,0,3)", "(0,0,nan)"), "space vector");
  refuses("a.nrrd", replaced(nrrd(), "(0,0,3)", "(0,0,0)"), "spacing");
}

TEST_F(ImportImage, RefusesSizesThatCannotBe) {
  refuses("a.nii", with_number<std::int16_t>(nifti(), 42, 0), "size");
  refuses("a.nii", with_number<std::int16_t>(nifti(), 42, -3), "size");
  refuses("a.nii", with_number<std::int16_t>(nifti(), 42, 32767), "truncated");
  const std::string two = with_number<std::int16_t>(with_number<std::int16_t>(nifti(), 40, 4), 48, 2);
  refuses("a.nii", two, "truncated");
  refuses("a.nii", two + RawImage::payload(), "2 volumes; choose one with --component 1 to 2");
  refuses("a.nii", with_number<std::int16_t>(nifti(), 40, 1), "dimensions");
  refuses("a.nii", with_number<float>(nifti(), 108, 1e30f), "byte");
  refuses("a.nii", with_number<float>(nifti(), 108, -1.f), "byte");
  refuses("a.nii", with_number<std::int16_t>(nifti(), 72, 8), "bits");
  const std::string meta = meta_header() + RawImage::payload();
  refuses("a.mha", replaced(meta, "8 4 2", "99999999 9 9"), "size");
  refuses("a.mha", replaced(meta, "8 4 2", "1000 1000 100"), "truncated");
  refuses("a.mha", replaced(meta, "8 4 2", "8.5 4 2"), "'8.5 4 2'");
  EXPECT_TRUE(import_bytes("a.mha", replaced(meta, "8 4 2", "8.0 4 2")));
  for (const char* encoding : {"hex", "ascii"})
    refuses("a.nrrd", nrrd_header(encoding) + std::string(100, '0'), "must fit its pixels");
  // A gigabyte cannot come from a kilobyte of gzip: refused ahead of allocation.
  refuses("a.nrrd", replaced(compressed_nrrd(), "8 4 2", "1024 1024 512"), "truncated");
}

TEST_F(ImportImage, RefusesPixelsThatAtlasesDoNotTake) {
  refuses("a.nii", with_number<std::int16_t>(nifti(), 70, 32), "type 32");    // complex
  refuses("a.nii", with_number<std::int16_t>(nifti(), 70, 128), "type 128");  // RGB
  refuses("a.nrrd", replaced(nrrd(), "type: short", "type: MET_SHORT"), "type");
  refuses("a.mha", replaced(meta_image(), "MET_SHORT", "short"), "type short");
  const std::string channels = meta_header("ElementNumberOfChannels = 3\n"), pixels = RawImage::payload();
  refuses("a.mha", channels + pixels + pixels + pixels, "3 volumes");
  std::string vectors = replaced(nrrd(), "sizes: 8 4 2", "sizes: 2 4 8");
  vectors = replaced(vectors, "kinds: domain", "kinds: vector");
  EXPECT_FALSE(import_bytes("a.nrrd", replaced(vectors, "(1,0,0)", "none   ")));
}

TEST_F(ImportImage, RefusesPixelsElsewhere) {
  write_bytes(folder_.file("pixels.raw"), RawImage::payload());
  std::filesystem::create_directory(folder_.path() / "below");
  for (const std::string& name :
       {std::string("../pixels.raw"), folder_.file("pixels.raw"), std::string("/etc/passwd")}) {
    refuses("below/a.mhd", meta_header("", name), "outside its own folder");
    refuses("below/a.nhdr", nrrd_header("raw", "data file: " + name + "\n"), "outside its own folder");
  }
  std::filesystem::create_symlink(folder_.path() / "pixels.raw", folder_.path() / "below" / "link.raw");
  refuses("below/a.mhd", meta_header("", "link.raw"), "outside its own folder");
  refuses("a.mhd", meta_header("", "slice%03d.raw 0 3 1"), "several files");
  // The readers of ITK take every name that begins so for a list, whose lines may name any file.
  for (const std::string name : {"LIST", "LISTx", "LIST3", "LIST\t2", "SKIPLIST"}) {
    write_bytes(folder_.file(name), RawImage::payload());
    refuses("a.mhd", meta_header("", name), "several files");
    refuses("a.nhdr", nrrd_header("raw", "data file: " + name + "\n"), "several files");
  }
  EXPECT_FALSE(import_bytes("a.mhd", meta_header("", "missing.raw")));
}

TEST_F(ImportImage, RefusesWhatIsNoImage) {
  refuses("a.nii.gz", "just some text", "ending");
  refuses("b.nii.gz", deflated("just some text", true), "NIfTI");
  refuses("a.nii", std::string(1000, ' '), "NIfTI");
  refuses("a.mha", "<html></html>\n", "MetaImage");
  refuses("a.nrrd", "<html></html>\n", "NRRD");
  refuses("a.nii", deflated(nifti(), true), "ending");
  refuses("a.nii.gz", nifti(), "ending");
  refuses("a.txt", "text", "no known type");
  EXPECT_THAT(import_image(folder_.file("missing.nii")).error().message, HasSubstr("no such file"));
  EXPECT_THAT(import_image(folder_.path()).error().message, HasSubstr("folder"));
  ASSERT_EQ(mkfifo(folder_.file("pipe.nii").c_str(), 0600), 0);
  EXPECT_THAT(import_image(folder_.file("pipe.nii")).error().message, HasSubstr("regular file"));
}

TEST_F(ImportImage, CountsThePixelsOfATruncatedFileAlike) {
  const std::string cut = nifti().substr(0, 400);
  refuses("cut.nii", cut, "promises 128 bytes of pixels, 48 are there");
  refuses("cut.nii.gz", deflated(cut, true), "promises 128 bytes of pixels, 48 are there");
}

TEST(CheckSameGrid, GivesBothValues) {
  const Grid a{.size = {10, 20, 30}, .spacing_mm = {1, 2, 3}};
  Grid b = a;
  EXPECT_TRUE(check_same_grid(a, "a", b, "b"));
  b.size[2] = 31;
  EXPECT_THAT(check_same_grid(a, "a.nii", b, "b.nii").error().message,
              testing::AllOf(HasSubstr("a.nii has 10x20x30"), HasSubstr("b.nii has 10x20x31")));
  b = a;
  b.origin_lps_mm[1] += 0.01;  // half a hundredth of a voxel
  EXPECT_TRUE(check_same_grid(a, "a", b, "b"));
  b.origin_lps_mm[1] += 0.02;
  EXPECT_FALSE(check_same_grid(a, "a", b, "b"));
  b = a;
  b.spacing_mm[2] = 3.01;  // a tenth of a voxel at the far end
  EXPECT_FALSE(check_same_grid(a, "a", b, "b"));
  b = a;
  b.direction_lps = {1, 0, 0, 0, -1, 0, 0, 0, 1};
  EXPECT_FALSE(check_same_grid(a, "a", b, "b"));
}

TEST_F(ImportImage, MasksAtTheTopComeBeforeDicomBelow) {
  std::filesystem::create_directories(folder_.path() / "mix" / "dicom");
  write_bytes(folder_.file("mix/dicom/slice"), std::string(128, '\0') + "DICM");
  ASSERT_NE(find_image_format(folder_.path() / "mix"), nullptr);
  write_bytes(folder_.file("mix/liver.nii"), nifti());
  EXPECT_EQ(find_image_format(folder_.path() / "mix"), nullptr);
}

TEST_F(ImportImage, PicturesNeedDistances) {
  write_bytes(folder_.file("a.tif"), "no picture");
  EXPECT_THAT(import_image(folder_.file("a.tif")),
              FailsWith(ErrorCode::kUsage, HasSubstr("--spacing X,Y,Z")));
  Notes notes;
  ImageOptions options;
  options.spacing_mm = Vec3{1, 1, 1};
  EXPECT_THAT(import_image(folder_.file("a.tif"), options, notes).error().message,
              HasSubstr("not the picture"));
}

}  // namespace
}  // namespace splatlas
