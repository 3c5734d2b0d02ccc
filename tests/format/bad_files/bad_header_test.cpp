// Invalid files: the header.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return Bytes(bytes.begin(), bytes.end());
}

/// A flipped bit under the old checksums.
struct Flip {
  const char* what;
  std::size_t at;
  const char* message = "";
};

constexpr Flip kMagicBytes[] = {{"byte 0", 0, "99 53 50 4c 41 54 0d 0a"},
                                {"byte 7", 7, "89 53 50 4c 41 54 0d 1a"}};

constexpr Flip kHeaderBytes[] = {{"major version", 8}, {"directory checksum", 48}, {"header checksum", 56}};

constexpr Flip kDirectoryBytes[] = {{"the first byte", 64}, {"a byte", 1000}};

constexpr BadFile<Bytes> kForeignFiles[] = {
    {"one other byte", [](Bytes& f) { f = bytes_of("\n"); }, "0a"},
    {"plain text", [](Bytes& f) { f = bytes_of("name,label\ncore,7\n"); }, "6e 61 6d 65 2c 6c 61 62"},
};

constexpr BadFile<Bytes> kOtherLengths[] = {
    {"nothing", [](Bytes& f) { f.clear(); }, "not an atlas (its size is 0 bytes)"},
    {"all of the header but a byte", [](Bytes& f) { f.resize(63); },
     "truncated: the header has 64 bytes, the file has 63"},
    {"one byte more", [](Bytes& f) { f.push_back(std::byte{0}); },
     "1 trailing bytes: header says {0} bytes, file has {1}"},
    {"twice the file",
     [](Bytes& f) {
       const Bytes copy = f;
       f.insert(f.end(), copy.begin(), copy.end());
     },
     "{0} trailing bytes: header says {0} bytes, file has {1}"},
};

using BadHeader = BadFile<FileHeader>;

constexpr BadPart<FileHeader> kVersions[] = {
    {[](auto& h) { h.major = 0; }, "format 0, this program reads format 1"},
    {[](auto& h) { h.major = 2; }, "format 2, this program reads format 1"},
    {[](auto& h) { h.required_features = 1; },
     "format features 0x1 that this program (format 1.0) does not know"},
    {[](auto& h) { h.major = 3, h.required_features = 4; }, "format 3, this program reads format 1"},
};

constexpr BadPart<FileHeader> kSizes[] = {
    {[](auto& h) { --h.file_bytes; }, "1 trailing bytes: header says {2} bytes, file has {1}"},
    {[](auto& h) { ++h.file_bytes; }, "truncated: header says {3} bytes, file has {1}"},
    {[](auto& h) { h.directory_bytes = h.file_bytes; },
     "invalid: directory of {0} bytes in a file of {1} (limit 1073741824)"},
    {[](auto& h) { h.directory_bytes = (1u << 30) + 1; },
     "invalid: directory of 1073741825 bytes in a file of {1} (limit 1073741824)"},
    {[](auto& h) { h.directory_bytes = ~std::uint64_t{0}; },
     "invalid: directory of 18446744073709551615 bytes in a file of {1} (limit 1073741824)"},
};

constexpr BadPart<FileHeader> kOffsets[] = {
    {[](auto& h) { h.directory_offset = 0; }, "0"},
    {[](auto& h) { h.directory_offset = ~std::uint64_t{0} - 7; }, "18446744073709551608"},
};

constexpr BadPart<FileHeader> kDirectories[] = {
    {[](auto& h) { h.directory_bytes = 0; }},
    {[](auto& h) { --h.directory_bytes; }},
    {[](auto& h) { ++h.directory_bytes; }},
    {[](auto& h) { ++h.directory_checksum; }},
};

constexpr BadHeader kValidHeaders[] = {
    {"a newer minor version", [](auto& h) { h.minor = 9; }},
    {"optional features", [](auto& h) { h.optional_features = ~0u; }},
    {"reserved bits", [](auto& h) { h.reserved = ~0u; }},
};

/// Expects the fault of a checksum, with both values, for each row.
template <typename Row, std::size_t kRows, typename Apply>
void expect_wrong_checksums(const Row (&rows)[kRows], bool of_directory, const Apply& apply) {
  for (const Row& row : rows) {
    RawAtlas atlas = raw_atlas(good_file());
    apply(atlas, row);
    const Bytes bytes = file_of(atlas);
    const FileHeader header = header_of(bytes);
    const auto part = of_directory ? std::span(bytes).subspan(sizeof header, header.directory_bytes)
                                   : std::span(bytes).first(offsetof(FileHeader, header_checksum));
    EXPECT_EQ(
        fault_of_file(bytes),
        fmt::format("F: damaged: checksum of the {} is {:016x}, the file states {:016x}; copy or build the "
                    "file again",
                    of_directory ? "directory" : "header", checksum_of(part),
                    of_directory ? header.directory_checksum : header.header_checksum));
  }
}

TEST(BadFiles, ThatAreNoAtlases) {
  const auto in_file = [](RawAtlas& a, const auto& row) { a.on_file = row.change; };
  expect_faults(kForeignFiles, "F: not an atlas (its first bytes are {})", in_file);
  expect_faults(kOtherLengths, "F: {}", in_file);
}

TEST(BadFiles, WithAFlippedByte) {
  const auto flip = [](RawAtlas& a, const Flip& row) {
    a.on_file = [at = row.at](Bytes& f) { f[at] ^= std::byte{0x10}; };
  };
  expect_faults(kMagicBytes, "F: not an atlas (its first bytes are {})", flip);
  expect_wrong_checksums(kHeaderBytes, false, flip);
  expect_wrong_checksums(kDirectoryBytes, true, flip);
}

TEST(BadFiles, WithAForgedHeader) {
  const auto in_header = [](RawAtlas& a, const auto& row) { a.on_header = row.change; };
  expect_faults(kVersions, "F: needs {}", in_header);
  expect_faults(kSizes, "F: {}", in_header);
  expect_faults(kOffsets, "F: invalid: directory at {}, expected 64", in_header);
  expect_wrong_checksums(kDirectories, true, in_header);
  expect_faults(kValidHeaders, "", in_header);
}

}  // namespace
}  // namespace splatlas
