// Formats beside the three that ITK wrote first: bytes as their specifications say.
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/import/images/import_image.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "tests/preprocess/import/images/import_image_fixture.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

/// Bytes written one number after another.
class Bytes {
 public:
  explicit Bytes(std::size_t size) : bytes_(size, '\0') {}
  template <typename T>
  Bytes& put(std::size_t offset, T value) {
    bytes_ = with_number(std::move(bytes_), offset, value);
    return *this;
  }
  /// In the other byte order.
  template <typename T>
  Bytes& put_swapped(std::size_t offset, T value) {
    put(offset, value);
    std::reverse(bytes_.begin() + static_cast<std::ptrdiff_t>(offset),
                 bytes_.begin() + static_cast<std::ptrdiff_t>(offset + sizeof(T)));
    return *this;
  }
  Bytes& text(std::size_t offset, const std::string& value) {
    bytes_.replace(offset, value.size(), value);
    return *this;
  }
  [[nodiscard]] const std::string& get() const { return bytes_; }

 private:
  std::string bytes_;
};

template <typename T>
std::string pixels_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

class MoreFormats : public ImportImage {
 protected:
  SourceImage source(const std::string& name, const std::string& bytes,
                     const ImageOptions& options = {}) const {
    write_bytes(folder_.file(name), bytes);
    Result<SourceImage> image = read_image(folder_.file(name), options);
    if (!image) throw std::runtime_error(image.error().message);
    return *std::move(image);
  }
};

/// x to the left, y to the front, centred: SPM's and nibabel's rule.
TEST_F(MoreFormats, ReadsAnalyzePairsAndSaysWhatItAssumes) {
  std::string header = nifti_header().substr(0, 348);
  header.replace(344, 4, 4, '\0');
  header = with_number<float>(with_number<std::int16_t>(header, 254, 0), 108, 0);
  write_bytes(folder_.file("a.img"), RawImage::payload());
  const SourceImage image = source("a.hdr", header);
  EXPECT_EQ(image.grid.direction_lps, (Matrix3{1, 0, 0, 0, -1, 0, 0, 0, 1}));
  EXPECT_EQ(image.grid.origin_lps_mm, (Vec3{-3.5, 3, -1.5}));
  EXPECT_THAT(messages_of(image.notes),
              ElementsAre(HasSubstr("no orientation and is read with x to the left")));
  expect_raw_image(*import_image(folder_.file("a.img")));
  std::filesystem::remove(folder_.file("a.img"));
  EXPECT_THAT(import_image(folder_.file("a.hdr")).error().message, HasSubstr("a.img: cannot be opened"));
}

TEST_F(MoreFormats, NarrowsIntegersOf64Bits) {
  const auto of = [](std::int16_t datatype, const auto& values) {
    return with_number<std::int16_t>(with_number<std::int16_t>(nifti_header(), 70, datatype), 72, 64) +
           pixels_of(values);
  };
  std::vector<std::int64_t> values(RawImage::kVoxels, -7);
  values[3] = 2147483647;
  const Image narrow = imported("a.nii", of(1024, values));
  ASSERT_EQ(narrow.voxels.type, VoxelType::kInt32);
  EXPECT_EQ(narrow.voxels.as<std::int32_t>()[3], 2147483647);
  EXPECT_EQ(narrow.voxels.as<std::int32_t>()[4], -7);
  values[3] = 2147483648;
  refuses("a.nii", of(1024, values), "2147483648 does not fit 32 bits");
  std::vector<std::uint64_t> naturals(RawImage::kVoxels, 0);
  naturals[1] = 4294967295;
  const Image natural = imported("a.nii", of(1280, naturals));
  ASSERT_EQ(natural.voxels.type, VoxelType::kUInt32);
  EXPECT_EQ(natural.voxels.as<std::uint32_t>()[1], 4294967295u);
  const std::string nrrd64 =
      replaced(nrrd_header(), "type: short", "type: longlong") + pixels_of(std::vector<std::int64_t>(64, 9));
  EXPECT_EQ(imported("a.nrrd", nrrd64).voxels.as<std::int32_t>()[63], 9);
}

/// The sform counts; its qform would mirror the volume.
TEST_F(MoreFormats, TellsOfContradictingOrientations) {
  // Quaternion 0: x to the right, where the sform of the other file says left.
  std::string both = with_number<std::int16_t>(nifti(), 252, 1);
  both = with_number<float>(with_number<float>(with_number<float>(both, 268, 10), 272, 20), 276, 30);
  EXPECT_TRUE(source("same.nii", both).notes.empty());
  const std::string mirrored = with_number<float>(with_number<float>(both, 280, -1), 292, 17);
  const SourceImage image = source("mirrored.nii", mirrored);
  EXPECT_EQ(image.grid.direction_lps[0], 1);
  EXPECT_EQ(image.grid.origin_lps_mm[0], -17);
  EXPECT_THAT(messages_of(image.notes),
              ElementsAre(AllOf(HasSubstr("two orientations that differ; its sform is used"),
                                HasSubstr("7 mm elsewhere"))));
  std::string singular = both;
  for (std::size_t n = 0; n < 12; ++n) singular = with_number<float>(singular, 280 + 4 * n, 0);
  EXPECT_THAT(messages_of(source("singular.nii", singular).notes),
              ElementsAre(HasSubstr("singular sform; its qform is used")));
  refuses("alone.nii", with_number<std::int16_t>(singular, 252, 0), "singular orientation");
}

TEST_F(MoreFormats, ConvertsUnits) {
  std::string metres = nifti();
  metres[123] = 1;
  const SourceImage image = source("a.nii", metres);
  EXPECT_EQ(image.grid.spacing_mm, (Vec3{1000, 2000, 3000}));
  EXPECT_EQ(image.grid.origin_lps_mm, (Vec3{-10000, -20000, 30000}));
  EXPECT_THAT(messages_of(image.notes), ElementsAre(HasSubstr("another unit than mm")));
  EXPECT_THAT(messages_of(source("a.nii", with_number<float>(nifti(), 280, 101)).notes),
              ElementsAre(HasSubstr("unknown unit of length")));
}

TEST_F(MoreFormats, ConvertsUnitsOfTextHeaders) {
  const std::string unit = "space units: \"microns\" \"microns\" \"microns\"\n";
  EXPECT_EQ(source("a.nrrd", nrrd_header("raw", unit) + RawImage::payload()).grid.spacing_mm,
            (Vec3{0.001, 0.002, 0.003}));
  const SourceImage unknown =
      source("a.nrrd", nrrd_header("raw", replaced(unit, "microns", "ells")) + RawImage::payload());
  EXPECT_EQ(unknown.grid.spacing_mm, (Vec3{1, 2, 3}));
  EXPECT_THAT(messages_of(unknown.notes), ElementsAre(HasSubstr("unknown unit of length")));
  refuses("a.nrrd", nrrd_header("raw", "space units: mm mm mm\n") + RawImage::payload(), "double quotes");
  EXPECT_EQ(source("a.mha", meta_header("DistanceUnits = cm\n") + RawImage::payload()).grid.spacing_mm,
            (Vec3{10, 20, 30}));
}

/// A file of exactly this name comes before a pattern of names.
TEST_F(MoreFormats, TakesAPercentSignForAName) {
  write_bytes(folder_.file("a(%d=5).raw"), RawImage::payload());
  const std::string header = replaced(meta_header(""), "LOCAL", "a(%d=5).raw");
  expect_raw_image(imported("a.mhd", header));
  refuses("a.mhd", replaced(header, "%d", "%03d"), "spreads its pixels over several files");
}

TEST_F(MoreFormats, RefusesFilesCompressedTwice) {
  refuses("a.nii.gz", deflated(deflated(nifti(), true), true), "is compressed twice; gunzip it once");
}

/// Scripts leave gaps between segments, begin at 1, leave out ids, repeat values, and write colours to 255.
TEST_F(MoreFormats, ReadsSegmentsOfScripts) {
  const SourceImage image = source(
      "a.seg.nrrd", nrrd_header("raw",
                                "Segment1_Name:=liver\nSegment1_LabelValue:=1\nSegment1_Color:=204 51 26\n"
                                "Segment7_ID:=b\nSegment7_LabelValue:=3\nSegment7_Color:=1 0 0\n"
                                "Segment8_Name:=lobe\nSegment8_LabelValue:=1\n") +
                        RawImage::payload());
  ASSERT_EQ(image.notes.all().size(), 1u);
  EXPECT_THAT(image.notes.all()[0].message(), HasSubstr("and is dropped: lobe (1)"));
  ASSERT_EQ(image.segments.size(), 2u);
  EXPECT_EQ(image.segments[0].structure.name, "liver");
  EXPECT_EQ(image.segments[0].structure.color, (Rgb{204, 51, 26}));
  EXPECT_EQ(image.segments[1].structure.name, "b");
  EXPECT_EQ(image.segments[1].value, 3);
  EXPECT_EQ(image.segments[1].structure.color, (Rgb{1, 0, 0}));
}

TEST_F(MoreFormats, ReadsSegmentsOfMitk) {
  const std::string key = "org.mitk.multilabel.segmentation.labelgroups:=";
  const std::string group = R"([{"labels":[{"value":5,"name":"heart","color":{"value":[0.8,0.2,0.1]}}]}])";
  const SourceImage image = source("a.nrrd", nrrd_header("raw", key + group + "\n") + RawImage::payload());
  ASSERT_EQ(image.segments.size(), 1u);
  EXPECT_EQ(image.segments[0].value, 5);
  EXPECT_EQ(image.segments[0].structure.name, "heart");
  EXPECT_EQ(image.segments[0].structure.color, (Rgb{204, 51, 26}));
  const std::string groups =
      R"([{"labels":[{"value":5,"name":"A","color":{"value":[204,51,26]}},)"
      R"({"value":6,"name":"B"},{"value":7,"name":"C","color":{"value":[256,0,0]}}]}])";
  const SourceImage bytes = source("a.nrrd", nrrd_header("raw", key + groups + "\n") + RawImage::payload());
  EXPECT_EQ(bytes.segments.at(0).structure.color, (Rgb{204, 51, 26}));
  EXPECT_THAT(bytes.notes.all()[0].message(), HasSubstr("1 colour cannot be read and is left out: \"[256,"));
  refuses("a.nrrd", nrrd_header("raw", key + "[{}]\n") + RawImage::payload(), "names of MITK");
  const SourceImage old =
      source("a.nrrd", nrrd_header("raw", "label_000_00001:=<Label name=\"a\"/>\n") + RawImage::payload());
  EXPECT_THAT(old.notes.all().front().message(),
              HasSubstr("1 file has names of labels in a form that is not"));
}

TEST_F(MoreFormats, ChoosesAVolumeOfSeveral) {
  const std::string two = with_number<std::int16_t>(with_number<std::int16_t>(nifti(), 40, 4), 48, 2);
  std::vector<std::int16_t> second(RawImage::kVoxels, 5);
  write_bytes(folder_.file("a.nii"), two + pixels_of(second));
  Notes notes;
  ImageOptions options;
  options.component = 1;
  expect_raw_image(*import_image(folder_.file("a.nii"), options, notes));
  options.component = 2;
  EXPECT_EQ(import_image(folder_.file("a.nii"), options, notes)->voxels.as<std::int16_t>()[0], 5);
  options.component = 3;
  EXPECT_THAT(import_image(folder_.file("a.nii"), options, notes).error().message, HasSubstr("from 1 to 2"));
}

/// TotalSegmentator's extension: code 0, XML of Caret, zero bytes behind it.
TEST_F(MoreFormats, ReadsNamesOfLabelsFromAHeader) {
  std::string xml =
      "<?xml version=\"1.0\"?> <CaretExtension> <VolumeInformation Index=\"0\"> <LabelTable>"
      "<Label Key=\"1\" Red=\"0\" Green=\"1\" Blue=\"0\" Alpha=\"1\"><![CDATA[spleen]]></Label>\n"
      "<Label Key=\"12\" Red=\"1\" Green=\"0\" Blue=\"0\" Alpha=\"1\">kidney &amp; left</Label>"
      "</LabelTable> <Patient>Doe^John</Patient></VolumeInformation></CaretExtension>";
  xml.resize((xml.size() + 8 + 15) / 16 * 16 - 8, '\0');
  Bytes extension(12);
  extension.put<std::int8_t>(0, 1).put<std::int32_t>(4, static_cast<std::int32_t>(xml.size() + 8));
  const std::string header = nifti_header().substr(0, 348);
  const auto offset = static_cast<float>(348 + 12 + xml.size());
  const SourceImage image =
      source("a.nii", with_number<float>(header, 108, offset) + extension.get() + xml + RawImage::payload());
  ASSERT_EQ(image.segments.size(), 2u);
  EXPECT_EQ(image.segments[0].structure.name, "spleen");
  EXPECT_EQ(image.segments[1].value, 12);
  EXPECT_EQ(image.segments[1].structure.name, "kidney & left");
  EXPECT_FALSE(image.is_segmentation);
  xml.replace(0, 18, "VALUE_LABEL_DTABLE").replace(xml.find("<LabelTable"), 11, "<LABELTABLE");
  const SourceImage afni =
      source("a.nii", with_number<float>(header, 108, offset) + extension.get() + xml + RawImage::payload());
  EXPECT_THAT(afni.notes.all().front().message(),
              HasSubstr("1 file has names of labels in a form that is not"));
}

/// Big-endian, and the position of index size / 2 in RAS.
std::string mgh(std::int32_t frames = 1) {
  Bytes h(284);
  h.put_swapped<std::int32_t>(0, 1).put_swapped<std::int32_t>(4, 8).put_swapped<std::int32_t>(8, 4);
  h.put_swapped<std::int32_t>(12, 2).put_swapped<std::int32_t>(16, frames).put_swapped<std::int32_t>(20, 4);
  h.put_swapped<std::int16_t>(28, 1);
  const std::array<float, 15> numbers{1, 2, 3, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7};
  for (std::size_t n = 0; n < numbers.size(); ++n) h.put_swapped(30 + 4 * n, numbers[n]);
  std::string pixels = RawImage::payload();
  for (std::size_t at = 0; at < pixels.size(); at += 2) std::swap(pixels[at], pixels[at + 1]);
  std::string bytes = h.get();
  for (std::int32_t n = 0; n < frames; ++n) bytes += pixels;
  return bytes;
}

TEST_F(MoreFormats, ReadsMghInScannerCoordinates) {
  for (const auto& [name, bytes] : {std::pair<const char*, std::string>{"a.mgh", mgh()},
                                    {"a.mgz", deflated(mgh(), true)},
                                    {"tags.mgh", mgh() + std::string(20, '\0') + "tags"}}) {
    const Image image = imported(name, bytes);
    expect_raw_image(image);
    // RAS origin: 5 + 8 / 2, 6 - 3 * 2 / 2, 7 + 2 * 4 / 2
    EXPECT_EQ(image.grid.origin_lps_mm, (Vec3{-9, -3, 11}));
    EXPECT_EQ(image.grid.direction_lps, (Matrix3{1, 0, 0, 0, 0, -1, 0, -1, 0}));
  }
  EXPECT_EQ(source("two.mgh", mgh(2)).layers, 2u);
  const std::string no_orientation = mgh().replace(28, 2, 2, '\0');
  const SourceImage default_frame = source("none.mgh", no_orientation);
  EXPECT_EQ(default_frame.grid.spacing_mm, (Vec3{1, 1, 1}));
  EXPECT_THAT(messages_of(default_frame.notes), ElementsAre(HasSubstr("FreeSurfer's default")));
}

TEST_F(MoreFormats, RefusesBadMghFiles) {
  refuses("a.mgh", mgh().substr(0, 300), "truncated");
  refuses("a.mgh", std::string(284, 'x'), "not an MGH file");
  refuses("a.mgz", mgh(), "ending");
  Bytes overlay(284);
  overlay.put_swapped<std::int32_t>(0, 1).put_swapped<std::int32_t>(4, 5000).put_swapped<std::int32_t>(8, 1);
  overlay.put_swapped<std::int32_t>(12, 1).put_swapped<std::int32_t>(16, 1).put_swapped<std::int32_t>(20, 3);
  refuses("a.mgh", overlay.get() + std::string(20000, '\0'), "values of the vertices of a surface");
  std::string skew = mgh();
  skew.replace(42, 4, std::string("\x40\x00\x00\x00", 4));  // 2.0
  refuses("a.mgh", skew, "axis 1 of length 2");
  const std::string packed = deflated(mgh(), true);
  for (std::size_t length = 0; length < packed.size(); length += 7)
    EXPECT_FALSE(import_bytes("a.mgz", packed.substr(0, length)));
}

constexpr const char* kSegments =
    "Segment0_ID:=Segment_1\nSegment0_Name:=left kidney\nSegment0_Color:=1 0.5 0\nSegment0_LabelValue:=2\n"
    "Segment0_Layer:=0\nSegment0_Tags:=A:b|TerminologyEntry:list~SCT^123037004^Anatomical "
    "Structure~SCT^64033007^Kidney~SCT^7771000^Left~~^^~^^|\n"
    "Segment1_ID:=Segment_2\nSegment1_Name:=cyst\nSegment1_LabelValue:=2\nSegment1_Layer:=1\n";

TEST_F(MoreFormats, ReadsLayersAndSegmentsOfSlicer) {
  const std::string pairs = kSegments;
  const auto header = [&](const std::string& sizes, const std::string& directions,
                          const std::string& encoding) {
    return "NRRD0004\ntype: uchar\ndimension: 4\nspace: left-posterior-superior\nsizes: " + sizes +
           "\nspace directions: " + directions +
           "\nkinds: list domain domain domain\nspace origin: (1,2,3)\nencoding: " + encoding + "\n" + pairs +
           "\n";
  };
  const std::string first{0, 0, 2, 0, 2, 0}, last{0, 2, 2, 0, 0, 0};  // voxel by voxel; layer by layer
  const std::string list_first = header("2 3 1 1", "none (1,0,0) (0,1,0) (0,0,1)", "raw") + first;
  const std::string packed =
      header("2 3 1 1", "none (1,0,0) (0,1,0) (0,0,1)", "gzip") + deflated(first, true);
  for (const std::string& bytes : {list_first, packed}) {
    const SourceImage image = source("a.seg.nrrd", bytes);
    EXPECT_TRUE(image.is_segmentation);
    EXPECT_EQ(image.layers, 2u);
    EXPECT_EQ(image.grid.size, (Index3{3, 1, 1}));
    const std::string voxels(reinterpret_cast<const char*>(image.voxels.bytes.data()),
                             image.voxels.bytes.size());
    EXPECT_EQ(voxels, last);
    ASSERT_EQ(image.segments.size(), 2u);
    EXPECT_EQ(image.segments[0].structure.name, "left kidney");
    EXPECT_EQ(image.segments[0].structure.color, (Rgb{255, 128, 0}));
    EXPECT_THAT(image.segments[0].structure.terms,
                ElementsAre(Term{"SNOMED", "64033007"}, Term{"modifier SNOMED", "7771000"}));
    EXPECT_EQ(image.segments[1].layer, 1u);
  }
}

/// "abcdefgh", as bzip2 1.0.8 compresses it.
TEST_F(MoreFormats, ReadsBzip2) {
  constexpr std::array<unsigned char, 44> kStream{
      0x42, 0x5a, 0x68, 0x39, 0x31, 0x41, 0x59, 0x26, 0x53, 0x59, 0x50, 0x24, 0xec, 0x61, 0x00,
      0x00, 0x00, 0x01, 0x00, 0x3f, 0xc0, 0x20, 0x00, 0x31, 0x0c, 0x08, 0x19, 0x1a, 0x69, 0x93,
      0x35, 0x73, 0xf9, 0x45, 0xdc, 0x91, 0x4e, 0x14, 0x24, 0x14, 0x09, 0x3b, 0x18, 0x40};
  const std::string stream(reinterpret_cast<const char*>(kStream.data()), kStream.size());
  const std::string header =
      "NRRD0004\ntype: uchar\ndimension: 3\nspace: LPS\nsizes: 2 2 2\nencoding: bzip2\n"
      "space directions: (1,0,0) (0,1,0) (0,0,1)\n\n";
  const Image image = imported("a.nrrd", header + stream);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(image.voxels.bytes.data()), 8), "abcdefgh");
  for (std::size_t length = 0; length < stream.size(); ++length)
    EXPECT_FALSE(import_bytes("a.nrrd", header + stream.substr(0, length))) << length;
  std::string damaged = stream;
  damaged[30] = static_cast<char>(damaged[30] ^ 1);
  EXPECT_FALSE(import_bytes("a.nrrd", header + damaged));
}

/// Pages of 3 x 2 uncompressed numbers (TIFF 6.0): the values of a page, then its directory.
template <typename T>
std::string tiff_of(const std::vector<std::vector<T>>& pages) {
  std::string bytes("II*\0\0\0\0\0", 8);
  std::size_t link = 4;
  for (const std::vector<T>& page : pages) {
    const auto strip = static_cast<std::uint32_t>(bytes.size());
    bytes += pixels_of(page);
    bytes.resize((bytes.size() + 1) / 2 * 2);
    const auto directory_at = static_cast<std::uint32_t>(bytes.size());
    bytes = with_number(std::move(bytes), link, directory_at);
    const std::array<std::pair<std::uint16_t, std::uint32_t>, 8> fields{{{256, 3},
                                                                         {257, 2},
                                                                         {258, 8 * sizeof(T)},
                                                                         {259, 1},
                                                                         {262, 1},
                                                                         {273, strip},
                                                                         {278, 2},
                                                                         {279, 6 * sizeof(T)}}};
    Bytes directory(2 + 12 * fields.size() + 4);
    directory.put(0, static_cast<std::uint16_t>(fields.size()));
    for (std::size_t n = 0; n < fields.size(); ++n) {
      const std::size_t at = 2 + 12 * n;
      directory.put(at, fields[n].first)
          .put<std::uint16_t>(at + 2, 4)
          .put<std::uint32_t>(at + 4, 1)
          .put(at + 8, fields[n].second);
    }
    link = bytes.size() + directory.get().size() - 4;
    bytes += directory.get();
  }
  return bytes;
}

/// ITK would read integers of 32 bits as background, and a cut file as one of fewer slices.
TEST_F(MoreFormats, ReadsEveryPageOfATiffFile) {
  const std::vector<std::vector<std::uint32_t>> pages{{1, 2, 3, 4, 5, 4294967295u}, {7, 8, 9, 10, 11, 12}};
  const std::string bytes = tiff_of(pages);
  ImageOptions options;
  options.spacing_mm = Vec3{1, 2, 3};
  const SourceImage image = source("a.tif", bytes, options);
  EXPECT_EQ(image.grid.size, (Index3{3, 2, 2}));
  EXPECT_EQ(image.grid.spacing_mm, (Vec3{1, 2, 3}));
  ASSERT_EQ(image.voxels.type, VoxelType::kUInt32);
  for (std::size_t v = 0; v < 12; ++v) EXPECT_EQ(image.voxels.as<std::uint32_t>()[v], pages[v / 6][v % 6]);
  EXPECT_THAT(messages_of(image.notes),
              ElementsAre(HasSubstr("no orientation and is read with x to the left")));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    write_bytes(folder_.file("a.tif"), bytes.substr(0, length));
    EXPECT_FALSE(read_pictures(folder_.file("a.tif"), options)) << length;
  }
}

}  // namespace
}  // namespace splatlas
