// Invalid files: streams of values and surfaces.
#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

/// Streams of values, by group.
enum Group : std::size_t { kOfEmpty, kOfCore, kOfCoreAndRim, kOfRim, kOfKnob, kOfNeedle };
/// Streams of surfaces, in preorder.
enum Surface : std::size_t { kRimSurface = 2, kNeedleSurface = 4 };

struct BadStream {
  const char* what;
  std::size_t stream;
  void (*change)(Bytes& bytes);
  const char* message = "";
};

void put_u32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, 4);
}

void clear(Bytes& bytes, std::size_t first, std::size_t last) {
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(first),
            bytes.begin() + static_cast<std::ptrdiff_t>(last), std::byte{0});
}

constexpr BadStream kValues[] = {
    {"a bucket too large", kOfCore, [](Bytes& b) { put_u32(b, 0, 1000); },
     "1: buckets contain more residuals than voxels"},
    {"buckets that wrap around", kOfRim,
     [](Bytes& b) { put_u32(b, 0, 0x80000000), put_u32(b, 4, 0x80000000); },
     "4: buckets contain more residuals than voxels"},
    {"empty buckets", kOfKnob, [](Bytes& b) { clear(b, 0, 64); },
     "5: buckets contain fewer residuals than voxels"},
    {"everything in the last bucket", kOfKnob, [](Bytes& b) { clear(b, 0, 64), put_u32(b, 60, 27); },
     "5: a bucket has too few residuals"},
    {"an error shift above the largest", kOfCore, [](Bytes& b) { b[78] = std::byte{16}; },
     "1: invalid value model"},
    {"a byte that must be 0", kOfRim, [](Bytes& b) { b[79] = std::byte{1}; }, "4: invalid value model"},
};

constexpr BadStream kOtherValues[] = {
    {"other residuals, which are other values", kOfNeedle, [](Bytes& b) { clear(b, 64, b.size()); }},
};

/// The end of the vertices of a surface: their length precedes both parts.
std::size_t end_of_vertices(const Bytes& bytes) {
  std::uint32_t vertices = 0;
  std::memcpy(&vertices, bytes.data(), 4);
  return 8 + vertices;
}

constexpr BadStream kSurfaces[] = {
    {"no lengths", kRimSurface, [](Bytes& b) { clear(b, 0, 8); }, "'rim': wrong length of the rotations"},
    {"vertices beyond the stream", kRimSurface, [](Bytes& b) { put_u32(b, 0, 0xffffffff); },
     "'rim': wrong length of its parts"},
    {"lengths that wrap around", kRimSurface,
     [](Bytes& b) { put_u32(b, 0, 0x80000000), put_u32(b, 4, 0x80000000); },
     "'rim': wrong length of its parts"},
    {"vertices of another codec", kRimSurface, [](Bytes& b) { b[8] ^= std::byte{0xff}; },
     "'rim': the vertex code begins with 0x5f, expected 0xa0"},
    {"triangles of another codec", kRimSurface, [](Bytes& b) { b[end_of_vertices(b)] ^= std::byte{0xff}; },
     "'rim': the index code begins with 0x1e, expected 0xe1"},
    {"a triangle with a vertex that is not there", kRimSurface,
     [](Bytes& b) { b[end_of_vertices(b) + 1] = std::byte{0xff}; }, "'rim': triangles cannot be decoded"},
    {"a vertex outside of the grid", kNeedleSurface,
     [](Bytes& b) {
       for (std::size_t end = end_of_vertices(b), n = end - 16; n < end; ++n) b[n] = std::byte{0xff};
     },
     "'needle': vertex 0 lies outside the grid"},
};

TEST(BadFiles, WithABadStream) {
  const auto in_section = [](SectionKind kind) {
    return [=](RawAtlas& a, const BadStream& row) { a.edit_stream(kind, row.stream, row.change); };
  };
  expect_faults(kValues, "F: invalid: values of class {}", in_section(SectionKind::kValues));
  expect_faults(kOtherValues, "", in_section(SectionKind::kValues));
  expect_faults(kSurfaces, "F: invalid: surface of structure {}", in_section(SectionKind::kSurfaces));
}

}  // namespace
}  // namespace splatlas
