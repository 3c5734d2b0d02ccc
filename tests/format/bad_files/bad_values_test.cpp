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
enum Surface : std::size_t { kOfAllS, kOfCoreS, kRimSurface, kOfKnobS, kNeedleSurface };

void put_u32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, 4);
}

constexpr BadFile kValues[] = {
    {"a bucket too large",
     [](RawAtlas& a) { a.edit_stream(SectionKind::kValues, kOfCore, [](Bytes& b) { put_u32(b, 0, 1000); }); },
     "F: invalid: values of class 1: buckets contain more residuals than voxels"},
    {"the largest bucket",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfCore, [](Bytes& b) { put_u32(b, 60, 0xffffffff); });
     },
     "F: invalid: values of class 1: buckets contain more residuals than voxels"},
    {"buckets that wrap around",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfRim, [](Bytes& b) {
         put_u32(b, 0, 0x80000000);
         put_u32(b, 4, 0x80000000);
       });
     },
     "F: invalid: values of class 4: buckets contain more residuals than voxels"},
    {"empty buckets",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfKnob,
                     [](Bytes& b) { std::fill(b.begin(), b.begin() + 64, std::byte{0}); });
     },
     "F: invalid: values of class 5: buckets contain fewer residuals than voxels"},
    {"everything in the last bucket",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfKnob, [](Bytes& b) {
         std::fill(b.begin(), b.begin() + 64, std::byte{0});
         put_u32(b, 60, 27);
       });
     },
     "F: invalid: values of class 5: a bucket has too few residuals"},
    {"of the empty class everything in the first bucket",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfEmpty, [](Bytes& b) {
         std::fill(b.begin(), b.begin() + 64, std::byte{0});
         put_u32(b, 0, 131);
       });
     },
     "F: invalid: values of class 0: a bucket has too few residuals"},
    {"an error shift above the largest",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfCore, [](Bytes& b) { b[78] = std::byte{16}; });
     },
     "F: invalid: values of class 1: invalid value model"},
    {"the largest number for an error shift",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfEmpty, [](Bytes& b) { b[78] = std::byte{255}; });
     },
     "F: invalid: values of class 0: invalid value model"},
    {"a byte that must be 0",
     [](RawAtlas& a) { a.edit_stream(SectionKind::kValues, kOfRim, [](Bytes& b) { b[79] = std::byte{1}; }); },
     "F: invalid: values of class 4: invalid value model"},
    {"other residuals, which are other values",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kValues, kOfNeedle,
                     [](Bytes& b) { std::fill(b.begin() + 64, b.end(), std::byte{0}); });
     },
     ""},
};

constexpr BadFile kSurfaces[] = {
    {"no lengths",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface,
                     [](Bytes& b) { std::fill(b.begin(), b.begin() + 8, std::byte{0}); });
     },
     "F: invalid: surface of structure 'rim': wrong length of the rotations"},
    {"vertices beyond the stream",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) { put_u32(b, 0, 0xffffffff); });
     },
     "F: invalid: surface of structure 'rim': wrong length of its parts"},
    {"triangles beyond the stream",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) { put_u32(b, 4, 0xffffffff); });
     },
     "F: invalid: surface of structure 'rim': wrong length of its parts"},
    {"lengths that wrap around",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) {
         put_u32(b, 0, 0x80000000);
         put_u32(b, 4, 0x80000000);
       });
     },
     "F: invalid: surface of structure 'rim': wrong length of its parts"},
    {"a byte of vertices given to the triangles",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) {
         b[0] = static_cast<std::byte>(std::to_integer<int>(b[0]) - 1);
         b[4] = static_cast<std::byte>(std::to_integer<int>(b[4]) + 1);
       });
     },
     "F: invalid: surface of structure 'rim': vertices cannot be decoded"},
    {"a byte more",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) { b.push_back(std::byte{0}); });
     },
     "F: invalid: surface of structure 'rim': wrong length of the rotations"},
    {"two bytes of rotations too many",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface,
                     [](Bytes& b) { b.insert(b.end(), 2, std::byte{0}); });
     },
     "F: invalid: surface of structure 'rim': wrong length of the rotations"},
    {"vertices of another codec",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) { b[8] ^= std::byte{0xff}; });
     },
     "F: invalid: surface of structure 'rim': vertices cannot be decoded"},
    {"triangles of another codec",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) {
         std::uint32_t vertices = 0;
         std::memcpy(&vertices, b.data(), 4);
         b[8 + vertices] ^= std::byte{0xff};
       });
     },
     "F: invalid: surface of structure 'rim': triangles cannot be decoded"},
    {"a triangle with a vertex that is not there",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kRimSurface, [](Bytes& b) {
         std::uint32_t vertices = 0;
         std::memcpy(&vertices, b.data(), 4);
         b[8 + vertices + 1] = std::byte{0xff};
       });
     },
     "F: invalid: surface of structure 'rim': triangles cannot be decoded"},
    {"no vertices' bytes",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kNeedleSurface, [](Bytes& b) { put_u32(b, 0, 0); });
     },
     "F: invalid: surface of structure 'needle': wrong length of the rotations"},
    {"a vertex outside of the grid",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kSurfaces, kNeedleSurface, [](Bytes& b) {
         std::uint32_t vertices = 0;
         std::memcpy(&vertices, b.data(), 4);
         for (std::size_t n = 8 + vertices - 16; n < 8 + vertices; ++n) b[n] = std::byte{0xff};
       });
     },
     "F: invalid: surface of structure 'needle': vertex 0 lies outside the grid"},
};

TEST(BadFiles, WithBadValues) {
  expect_refused(kValues);
}
TEST(BadFiles, WithABadSurface) {
  expect_refused(kSurfaces);
}

}  // namespace
}  // namespace splatlas
