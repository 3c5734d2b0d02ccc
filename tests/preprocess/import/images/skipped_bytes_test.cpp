// Pixels behind skipped bytes and lines; ITK's own readers are the reference.
#include <gtest/gtest.h>

#include "tests/preprocess/import/images/import_image_fixture.h"
#include "tests/preprocess/itk_volumes.h"

namespace splatlas {
namespace {

/// A file of pixels beside a header that skips its first bytes or lines.
struct SkippedCase {
  const char* name;
  std::string header, pixels;
};

class SkippedBytes : public ImportImage {
 protected:
  /// Writes "pixels" and the header, and returns the header's path.
  std::string write(const SkippedCase& file) const {
    write_bytes(folder_.file("pixels"), file.pixels);
    write_bytes(folder_.file(file.name), file.header);
    return folder_.file(file.name);
  }
};

std::string packed_meta_header(const std::string& pixels, const std::string& skip) {
  const std::string size = fmt::format("CompressedData = True\nCompressedDataSize = {}\n", pixels.size());
  return meta_header(size + skip, "pixels");
}

std::vector<SkippedCase> skipped_cases() {
  const std::string raw = RawImage::payload(), zlib = deflated(raw, false), gzip = deflated(raw, true);
  const std::string beside = "data file: pixels\n", lines = "one\ntwo\n";
  return {{"raw.mhd", meta_header("HeaderSize = 8\n", "pixels"), "12345678" + raw},
          {"end.mhd", meta_header("HeaderSize = -1\n", "pixels"), "12345678" + raw},
          {"zlib.mhd", packed_meta_header(zlib, "HeaderSize = 8\n"), "12345678" + zlib},
          {"byte.nhdr", nrrd_header("raw", beside + "byte skip: 3\n"), "abc" + raw},
          {"end.nhdr", nrrd_header("raw", beside + "byte skip: -1\n"), "abc" + raw},
          {"line.nhdr", nrrd_header("raw", beside + "line skip: 2\n"), lines + raw},
          {"both.nhdr", nrrd_header("raw", beside + "line skip: 2\nbyte skip: 3\n"), lines + "abc" + raw},
          {"byte_gzip.nhdr", nrrd_header("gzip", beside + "byte skip: 3\n"), deflated("abc" + raw, true)},
          {"end_gzip.nhdr", nrrd_header("gzip", beside + "byte skip: -1\n"), deflated("abc" + raw, true)},
          {"line_gzip.nhdr", nrrd_header("gzip", beside + "line skip: 2\n"), lines + gzip},
          {"both_gzip.nhdr", nrrd_header("gzip", beside + "line skip: 2\nbyte skip: 3\n"),
           lines + deflated("abc" + raw, true)}};
}

TEST_F(SkippedBytes, ArePassedAsByItk) {
  for (const SkippedCase& file : skipped_cases()) {
    SCOPED_TRACE(file.name);
    const std::string path = write(file);
    const Result<Image> image = import_image_here(path);
    EXPECT_TRUE(image) << image.error().message;
    if (!image) continue;
    expect_raw_image(*image);
    EXPECT_EQ(image->voxels.bytes, read_by_itk(path).voxels.bytes);
  }
}

TEST_F(SkippedBytes, TruncatedPixelsBehindThemAreRefused) {
  for (const SkippedCase& file : skipped_cases()) {
    const std::string path = write(file);
    // Pixels at the end of a file begin later if it is cut.
    const bool any_start =
        file.header.find(": -1") != std::string::npos || file.header.find("= -1") != std::string::npos;
    const bool is_raw = file.pixels.ends_with(RawImage::payload());
    // ITK reads compressed pixels at the end without the last bytes of their checksum.
    const std::size_t needed = !any_start ? file.pixels.size()
                               : is_raw   ? RawImage::payload().size()
                                          : file.pixels.size() - 8;
    for (std::size_t length = 0; length < needed; ++length) {
      write_bytes(folder_.file("pixels"), file.pixels.substr(0, length));
      EXPECT_FALSE(import_image_here(path)) << file.name << " cut to " << length;
    }
  }
}

TEST_F(SkippedBytes, DamagedCompressedPixelsBehindThemAreRefused) {
  for (SkippedCase file : skipped_cases()) {
    if (file.pixels.ends_with(RawImage::payload())) continue;
    file.pixels[file.pixels.size() - 20] = static_cast<char>(file.pixels[file.pixels.size() - 20] ^ 0x10);
    EXPECT_FALSE(import_image_here(write(file))) << file.name;
  }
}

/// HeaderSize counts from the start of the file, also in a file that holds header and pixels.
TEST_F(SkippedBytes, HeaderSizeIncludesTheHeaderInTheSameFile) {
  const std::string raw = RawImage::payload(), zlib = deflated(raw, false);
  const auto whole = [](const std::string& fields, const std::string& pixels) {
    const std::size_t length = meta_header(fields + "HeaderSize = 000\n").size() + 3;
    return meta_header(fields + fmt::format("HeaderSize = {:03}\n", length)) + "abc" + pixels;
  };
  const std::string packed = fmt::format("CompressedData = True\nCompressedDataSize = {}\n", zlib.size());
  for (const auto& [name, bytes] :
       {std::pair<const char*, std::string>{"raw.mha", whole("", raw)}, {"zlib.mha", whole(packed, zlib)}}) {
    SCOPED_TRACE(name);
    const Result<Image> image = import_bytes(name, bytes);
    EXPECT_TRUE(image) << image.error().message;
    if (!image) continue;
    expect_raw_image(*image);
    EXPECT_EQ(image->voxels.bytes, read_by_itk(folder_.file(name)).voxels.bytes);
  }
}

TEST_F(SkippedBytes, ImpossibleNumbersAreRefused) {
  const std::string raw = RawImage::payload(), zlib = deflated(raw, false);
  refuses("inside.mha", meta_header("HeaderSize = 8\n") + raw + "12345678", "HeaderSize = 8");
  refuses("inside_zlib.mha", meta_header("HeaderSize = 8\nCompressedData = True\n") + "12345678" + zlib,
          "HeaderSize = 8");
  for (const char* skip : {"byte skip: -2", "line skip: -1", "line skip: a", "byte skip: 2000000000000"})
    refuses("skip.nrrd", nrrd_header("gzip", std::string(skip) + "\n") + deflated(raw, true), "skip.nrrd");
  refuses("lines.nrrd", nrrd_header("gzip", "line skip: 1000\n") + deflated(raw, true), "skips 1000 lines");
  refuses("bytes.nrrd", nrrd_header("gzip", "byte skip: 1000000\n") + deflated(raw, true), "truncated");
  refuses("below.mha", meta_header("HeaderSize = -2\n") + raw, "HeaderSize = -2");
}

}  // namespace
}  // namespace splatlas
