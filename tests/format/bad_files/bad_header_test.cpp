// Invalid files: the header.
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "format/atlas_reader.h"
#include "format/system/exit_status.h"
#include "tests/format/bad_files/bad_files.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return Bytes(bytes.begin(), bytes.end());
}

template <std::size_t at>
void flip(Bytes& file) {
  file[at] ^= std::byte{0x10};
}

template <std::size_t length>
void cut(Bytes& file) {
  file.resize(length);
}

constexpr BadFile kNoAtlases[] = {
    {"nothing", [](RawAtlas& a) { a.on_file = [](Bytes& f) { f.clear(); }; },
     "F: not an atlas (the file is empty)"},
    {"one byte of the magic", [](RawAtlas& a) { a.on_file = cut<1>; },
     "F: truncated: the header has 64 bytes, the file has 1"},
    {"the magic alone", [](RawAtlas& a) { a.on_file = cut<8>; },
     "F: truncated: the header has 64 bytes, the file has 8"},
    {"all of the header but a byte", [](RawAtlas& a) { a.on_file = cut<63>; },
     "F: truncated: the header has 64 bytes, the file has 63"},
    {"the header alone", [](RawAtlas& a) { a.on_file = cut<64>; },
     "F: truncated: header says {0} bytes, file has 64"},
    {"half of the directory", [](RawAtlas& a) { a.on_file = cut<500>; },
     "F: truncated: header says {0} bytes, file has 500"},
    {"all but the last byte", [](RawAtlas& a) { a.on_file = [](Bytes& f) { f.pop_back(); }; },
     "F: truncated: header says {0} bytes, file has {1}"},
    {"one byte more", [](RawAtlas& a) { a.on_file = [](Bytes& f) { f.push_back(std::byte{0}); }; },
     "F: 1 trailing bytes: header says {0} bytes, file has {1}"},
    {"twice the file",
     [](RawAtlas& a) {
       a.on_file = [](Bytes& f) {
         const Bytes copy = f;
         f.insert(f.end(), copy.begin(), copy.end());
       };
     },
     "F: {0} trailing bytes: header says {0} bytes, file has {1}"},
    {"one other byte", [](RawAtlas& a) { a.on_file = [](Bytes& f) { f = bytes_of("\n"); }; },
     "F: not an atlas (its first bytes are 0a)"},
    {"plain text", [](RawAtlas& a) { a.on_file = [](Bytes& f) { f = bytes_of("name,label\ncore,7\n"); }; },
     "F: not an atlas (its first bytes are 6e 61 6d 65 2c 6c 61 62)"},
    {"a page of a web server",
     [](RawAtlas& a) { a.on_file = [](Bytes& f) { f = bytes_of("<!DOCTYPE html><title>404</title>"); }; },
     "F: not an atlas (its first bytes are 3c 21 44 4f 43 54 59 50)"},
    {"a gzip file",
     [](RawAtlas& a) { a.on_file = [](Bytes& f) { f = bytes_of("\x1f\x8b\x08\x04 and so on"); }; },
     "F: not an atlas (its first bytes are 1f 8b 08 04 20 61 6e 64)"},
    {"a PNG file",
     [](RawAtlas& a) { a.on_file = [](Bytes& f) { f = bytes_of("\x89PNG\r\n\x1a\n and so on"); }; },
     "F: not an atlas (its first bytes are 89 50 4e 47 0d 0a 1a 0a)"},
    {"zeros", [](RawAtlas& a) { a.on_file = [](Bytes& f) { f.assign(f.size(), std::byte{0}); }; },
     "F: not an atlas (its first bytes are 00 00 00 00 00 00 00 00)"},
    {"an atlas behind a byte order mark",
     [](RawAtlas& a) {
       a.on_file = [](Bytes& f) {
         const Bytes mark = bytes_of("\xef\xbb\xbf");
         f.insert(f.begin(), mark.begin(), mark.end());
       };
     },
     "F: not an atlas (its first bytes are ef bb bf 89 53 50 4c 41)"},
    {"line ends made those of Unix",
     [](RawAtlas& a) { a.on_file = [](Bytes& f) { f.erase(f.begin() + 6); }; },
     "F: not an atlas (its first bytes are 89 53 50 4c 41 54 0a 01)"},
    {"bytes made seven bits",
     [](RawAtlas& a) {
       a.on_file = [](Bytes& f) {
         for (std::byte& b : f) b &= std::byte{0x7f};
       };
     },
     "F: not an atlas (its first bytes are 09 53 50 4c 41 54 0d 0a)"},
    {"magic, byte 0", [](RawAtlas& a) { a.on_file = flip<0>; },
     "F: not an atlas (its first bytes are 99 53 50 4c 41 54 0d 0a)"},
    {"magic, byte 1", [](RawAtlas& a) { a.on_file = flip<1>; },
     "F: not an atlas (its first bytes are 89 43 50 4c 41 54 0d 0a)"},
    {"magic, byte 2", [](RawAtlas& a) { a.on_file = flip<2>; },
     "F: not an atlas (its first bytes are 89 53 40 4c 41 54 0d 0a)"},
    {"magic, byte 3", [](RawAtlas& a) { a.on_file = flip<3>; },
     "F: not an atlas (its first bytes are 89 53 50 5c 41 54 0d 0a)"},
    {"magic, byte 4", [](RawAtlas& a) { a.on_file = flip<4>; },
     "F: not an atlas (its first bytes are 89 53 50 4c 51 54 0d 0a)"},
    {"magic, byte 5", [](RawAtlas& a) { a.on_file = flip<5>; },
     "F: not an atlas (its first bytes are 89 53 50 4c 41 44 0d 0a)"},
    {"magic, byte 6", [](RawAtlas& a) { a.on_file = flip<6>; },
     "F: not an atlas (its first bytes are 89 53 50 4c 41 54 1d 0a)"},
    {"magic, byte 7", [](RawAtlas& a) { a.on_file = flip<7>; },
     "F: not an atlas (its first bytes are 89 53 50 4c 41 54 0d 1a)"},
};

/// Each field with flipped bits, under the old checksum.
constexpr BadFile kDamagedHeaders[] = {
    {"major version", [](RawAtlas& a) { a.on_file = flip<8>; }, "F: damaged: checksum of the header"},
    {"minor version", [](RawAtlas& a) { a.on_file = flip<10>; }, "F: damaged: checksum of the header"},
    {"required features", [](RawAtlas& a) { a.on_file = flip<12>; }, "F: damaged: checksum of the header"},
    {"optional features", [](RawAtlas& a) { a.on_file = flip<16>; }, "F: damaged: checksum of the header"},
    {"reserved", [](RawAtlas& a) { a.on_file = flip<20>; }, "F: damaged: checksum of the header"},
    {"file bytes", [](RawAtlas& a) { a.on_file = flip<24>; }, "F: damaged: checksum of the header"},
    {"directory offset", [](RawAtlas& a) { a.on_file = flip<32>; }, "F: damaged: checksum of the header"},
    {"directory bytes", [](RawAtlas& a) { a.on_file = flip<40>; }, "F: damaged: checksum of the header"},
    {"directory checksum", [](RawAtlas& a) { a.on_file = flip<48>; }, "F: damaged: checksum of the header"},
    {"header checksum", [](RawAtlas& a) { a.on_file = flip<56>; }, "F: damaged: checksum of the header"},
    {"the directory's first byte", [](RawAtlas& a) { a.on_file = flip<64>; },
     "F: damaged: checksum of the directory"},
    {"a byte of the directory", [](RawAtlas& a) { a.on_file = flip<1000>; },
     "F: damaged: checksum of the directory"},
};

constexpr BadFile kForgedHeaders[] = {
    {"major version 0", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.major = 0; }; },
     "F: needs format 0, this program reads format 1"},
    {"the next major version", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.major = 2; }; },
     "F: needs format 2, this program reads format 1"},
    {"the last major version", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.major = 65535; }; },
     "F: needs format 65535, this program reads format 1"},
    {"required feature 0", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.required_features = 1; }; },
     "F: needs format features 0x1 that this program (format 1.0) does not know"},
    {"required feature 31",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.required_features = 0x80000000; }; },
     "F: needs format features 0x80000000 that this program (format 1.0) does not know"},
    {"all required features",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.required_features = 0xffffffff; }; },
     "F: needs format features 0xffffffff that this program (format 1.0) does not know"},
    {"a major version and features",
     [](RawAtlas& a) {
       a.on_header = [](FileHeader& h) {
         h.major = 3;
         h.required_features = 4;
       };
     },
     "F: needs format 3, this program reads format 1"},
    {"no file bytes", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.file_bytes = 0; }; },
     "F: {0} trailing bytes: header says 0 bytes, file has {1}"},
    {"one file byte less", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { --h.file_bytes; }; },
     "F: 1 trailing bytes: header says {2} bytes, file has {1}"},
    {"one file byte more", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { ++h.file_bytes; }; },
     "F: truncated: header says {3} bytes, file has {1}"},
    {"the maximum file size",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.file_bytes = ~std::uint64_t{0}; }; },
     "F: truncated: header says 18446744073709551615 bytes, file has {1}"},
    {"a directory at 0", [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_offset = 0; }; },
     "F: invalid: directory at 0, expected 64"},
    {"a directory inside the header",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_offset = 56; }; },
     "F: invalid: directory at 56, expected 64"},
    {"a directory after a gap",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_offset = 72; }; },
     "F: invalid: directory at 72, expected 64"},
    {"a directory that wraps around",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_offset = ~std::uint64_t{0} - 7; }; },
     "F: invalid: directory at 18446744073709551608, expected 64"},
    {"a directory of no bytes",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_bytes = 0; }; },
     "F: damaged: checksum of the directory"},
    {"a directory of the whole file",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_bytes = h.file_bytes; }; },
     "F: invalid: directory of {0} bytes in a file of {1} (limit 1073741824)"},
    {"a directory one byte short",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { --h.directory_bytes; }; },
     "F: damaged: checksum of the directory"},
    {"a directory one byte long",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { ++h.directory_bytes; }; },
     "F: damaged: checksum of the directory"},
    {"a directory above the limit",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_bytes = (1u << 30) + 1; }; },
     "F: invalid: directory of 1073741825 bytes in a file of {1} (limit 1073741824)"},
    {"a directory of the maximum size",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.directory_bytes = ~std::uint64_t{0}; }; },
     "F: invalid: directory of 18446744073709551615 bytes in a file of {1} (limit 1073741824)"},
    {"another directory's checksum",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { ++h.directory_checksum; }; },
     "F: damaged: checksum of the directory"},
    {"a newer minor version, which is none",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.minor = 9; }; }, ""},
    {"optional features, which are none",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.optional_features = ~0u; }; }, ""},
    {"reserved bits, which are not read",
     [](RawAtlas& a) { a.on_header = [](FileHeader& h) { h.reserved = ~0u; }; }, ""},
};

TEST(BadFiles, ThatAreNoAtlases) {
  expect_refused(kNoAtlases);
}
TEST(BadFiles, WithADamagedHeader) {
  expect_refused(kDamagedHeaders);
}
TEST(BadFiles, WithAForgedHeader) {
  expect_refused(kForgedHeaders);
}

/// Refused without being read.
TEST(BadFiles, ThatAreNoFiles) {
  const TemporaryFolder folder;
  const auto refusal = [](const std::filesystem::path& path) {
    const auto atlas = Atlas::open(path);
    return atlas ? std::string()
                 : fmt::format("{} {}", exit_status(atlas.error().code), atlas.error().message);
  };
  const std::string name = folder.path().string();
  EXPECT_EQ(refusal(folder.path()), "3 " + name + ": not an atlas (a folder)");
  EXPECT_EQ(refusal(folder.path() / "none"),
            "1 " + name + "/none: cannot be opened: No such file or directory");
  ASSERT_EQ(::mkfifo((name + "/pipe").c_str(), 0600), 0);
  EXPECT_EQ(refusal(folder.path() / "pipe"), "3 " + name + "/pipe: not an atlas (not a regular file)");
  EXPECT_EQ(refusal("/dev/zero"), "3 /dev/zero: not an atlas (not a regular file)");
  std::filesystem::create_symlink("loop", folder.path() / "loop");
  EXPECT_EQ(refusal(folder.path() / "loop"),
            "1 " + name + "/loop: cannot be opened: Too many levels of symbolic links");
  std::ofstream(folder.path() / "empty");
  EXPECT_EQ(refusal(folder.path() / "empty"), "3 " + name + "/empty: not an atlas (the file is empty)");
}

}  // namespace
}  // namespace splatlas
