// Invalid files: Zstandard frames and run lists in intact chunks.

#include <gtest/gtest.h>
#include <zstd.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

using enum good::Class;

Bytes list(std::initializer_list<int> bytes) {
  Bytes result;
  for (const int b : bytes) result.push_back(static_cast<std::byte>(b));
  return result;
}

// ---- Zstandard frames

Bytes compressed(std::size_t bytes) {
  Bytes frame(ZSTD_compressBound(bytes));
  const Bytes content(bytes);
  frame.resize(ZSTD_compress(frame.data(), frame.size(), content.data(), content.size(), 1));
  return frame;
}

/// Replaces the values, fewer than 600 bytes when decoded, by a frame.
template <typename Make>
void set_frame(RawAtlas& a, const Make& make) {
  a.set_chunk(SectionKind::kValues, 0, make());
  a.chunk(SectionKind::kValues).codec = 1;
}

constexpr BadFile kFrames[] = {
    {"no frame", [](RawAtlas& a) { set_frame(a, [] {
                                     return list({1, 2, 3, 4, 5});
                                   }); },
     "F: damaged: not a Zstandard frame of values of classes 0 to 4"},
    {"one byte", [](RawAtlas& a) { set_frame(a, [] { return list({0x28}); }); },
     "F: damaged: not a Zstandard frame of values of classes 0 to 4"},
    {"the magic number alone",
     [](RawAtlas& a) { set_frame(a, [] {
                         return list({0x28, 0xb5, 0x2f, 0xfd});
                       }); },
     "F: damaged: not one Zstandard frame of values of classes 0 to 4"},
    {"half a frame",
     [](RawAtlas& a) {
       set_frame(a, [] {
         Bytes f = compressed(300);
         f.resize(f.size() / 2);
         return f;
       });
     },
     "F: damaged: not one Zstandard frame of values of classes 0 to 4"},
    {"a byte behind the frame",
     [](RawAtlas& a) {
       set_frame(a, [] {
         Bytes f = compressed(300);
         f.push_back(std::byte{0});
         return f;
       });
     },
     "F: damaged: not one Zstandard frame of values of classes 0 to 4"},
    {"two frames",
     [](RawAtlas& a) {
       set_frame(a, [] {
         Bytes f = compressed(300);
         const Bytes g = f;
         f.insert(f.end(), g.begin(), g.end());
         return f;
       });
     },
     "F: damaged: not one Zstandard frame of values of classes 0 to 4"},
    {"a skippable frame",
     [](RawAtlas& a) { set_frame(a, [] {
                         return list({0x50, 0x2a, 0x4d, 0x18, 4, 0, 0, 0, 1, 2, 3, 4});
                       }); },
     "F: damaged: not a Zstandard frame of values of classes 0 to 4"},
    {"a skippable frame behind the frame",
     [](RawAtlas& a) {
       set_frame(a, [] {
         Bytes f = compressed(300);
         const Bytes g = list({0x50, 0x2a, 0x4d, 0x18, 0, 0, 0, 0});
         f.insert(f.end(), g.begin(), g.end());
         return f;
       });
     },
     "F: damaged: not one Zstandard frame of values of classes 0 to 4"},
    {"a frame of less content", [](RawAtlas& a) { set_frame(a, [] { return compressed(8); }); },
     "F: damaged: wrong frame length (expected 487 bytes) of values of classes 0 to 4"},
    {"a frame of more content", [](RawAtlas& a) { set_frame(a, [] { return compressed(4096); }); },
     "F: damaged: wrong frame length (expected 487 bytes) of values of classes 0 to 4"},
    {"a bomb of a gibibyte",
     [](RawAtlas& a) {
       set_frame(a, [] {
         Bytes f = list({0x28, 0xb5, 0x2f, 0xfd, 0xa0, 0, 0, 0, 0x40});
         for (int n = 0; n < 40; ++n) {
           const Bytes block = list({n == 39, 0, 0x10, 0});
           f.insert(f.end(), block.begin(), block.end());
         }
         return f;
       });
     },
     "F: damaged: not one Zstandard frame of values of classes 0 to 4"},
    {"a frame that does not tell its content",
     [](RawAtlas& a) { set_frame(a, [] {
                         return list({0x28, 0xb5, 0x2f, 0xfd, 0, 0x58, 1, 0, 0});
                       }); },
     "F: damaged: wrong frame length (expected 487 bytes) of values of classes 0 to 4"},
    {"a frame that needs a dictionary",
     [](RawAtlas& a) {
       set_frame(a, [] {  // 487 zeros
         return list({0x28, 0xb5, 0x2f, 0xfd, 0x61, 0x77, 0xe7, 0, 0x3b, 0x0f, 0, 0});
       });
     },
     "F: damaged: its frame needs a dictionary of values of classes 0 to 4"},
};

// ---- run lists

constexpr BadFile kRunLists[] = {
    {"a mask of less voxels",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsZ, kCoreInterior, [](Bytes& b) { b = list({0, 255, 255, 255}); });
     },
     "F: invalid: runs_z of class 1: invalid mask"},
    {"a mask with bytes left",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsZ, kCoreInterior, [](Bytes& b) {
         b = list({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
       });
     },
     "F: invalid: runs_z of class 1: invalid mask"},
    {"more runs than voxels",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsZ, kCoreInterior, [](Bytes& b) { b[0] = std::byte{2}; });
     },
     "F: invalid: runs_z of class 1: run list says it has 2 runs"},
    {"the maximum number of runs",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsX, kCoreBoundary, [](Bytes& b) {
         b = list({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1});
       });
     },
     "F: invalid: runs_x of class 2: run list says it has 18446744073709551615 runs"},
    {"a number that does not end",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsY, kCoreInterior, [](Bytes& b) {
         b = list({0x81, 0x80, 0x80, 0x80});
       });
     },
     "F: invalid: runs_y of class 1: run list says it has 1 runs"},
    {"a number of more than 64 bits",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsZ, kCoreBoundary, [](Bytes& b) {
         b = list({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2, 0, 0, 0});
       });
     },
     "F: invalid: runs_z of class 2: run list says it has 9223372036854775807 runs"},
    {"bytes behind the list",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsZ, kCoreInterior, [](Bytes& b) { b.push_back(std::byte{0}); });
     },
     "F: invalid: runs_z of class 1: trailing bytes after the run list"},
    {"one byte too few",
     [](RawAtlas& a) { a.edit_stream(SectionKind::kRunsX, kCoreBoundary, [](Bytes& b) { b.pop_back(); }); },
     "F: invalid: runs_x of class 2: not a run list (run 6)"},
    {"a scanline beyond the grid",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kCoreInterior, [](ClassRuns& r) { r[0].scanline = 20; }); },
     "F: invalid: runs_z of class 1: run of 1 voxels at 2 of scanline 20 is not inside 20 scanlines of 10 "
     "voxels"},
    {"a scanline beyond all grids",
     [](RawAtlas& a) {
       a.edit_runs(Axis::kZ, kCoreInterior, [](ClassRuns& r) { r[0].scanline = ~std::uint64_t{0}; });
     },
     "F: invalid: runs_z of class 1: not a run list (run 0)"},
    {"a scanline twice, out of order",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kRimBoundary, [](ClassRuns& r) { r[1] = r[0]; }); },
     "F: invalid: runs_z of class 4: run at 4 of scanline 1 is out of order, or not apart from the run "
     "before it"},
    {"a start beyond the row",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kCoreInterior, [](ClassRuns& r) { r[0].start = 10; }); },
     "F: invalid: runs_z of class 1: run of 1 voxels at 10 of scanline 7 is not inside 20 scanlines of 10 "
     "voxels"},
    {"the largest start",
     [](RawAtlas& a) { a.edit_runs(Axis::kY, kCoreInterior, [](ClassRuns& r) { r[0].start = 0xffffffff; }); },
     "F: invalid: runs_y of class 1: run of 1 voxels at 4294967295 of scanline 9 is not inside 20 scanlines "
     "of 10 voxels"},
    {"an end beyond the row",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kRimBoundary, [](ClassRuns& r) { r[0].length = 9; }); },
     "F: invalid: runs_z of class 4: run of 9 voxels at 4 of scanline 1 is not inside 20 scanlines of 10 "
     "voxels"},
    {"no length",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kRimBoundary, [](ClassRuns& r) { r[0].length = 0; }); },
     "F: invalid: runs_z of class 4: run of 0 voxels at 4 of scanline 1 is not inside 20 scanlines of 10 "
     "voxels"},
    {"the largest length",
     [](RawAtlas& a) { a.edit_runs(Axis::kX, kRimBoundary, [](ClassRuns& r) { r[0].length = 0xffffffff; }); },
     "F: invalid: runs_x of class 4: run of 4294967295 voxels at 1 of scanline 16 is not inside 40 scanlines "
     "of 5 voxels"},
    {"a start below 0",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsZ, kCoreInterior, [](Bytes& b) { b.back() = std::byte{1}; });
     },
     "F: invalid: runs_z of class 1: not a run list (run 0)"},
    {"a length below 0",
     [](RawAtlas& a) {
       a.edit_stream(SectionKind::kRunsZ, kCoreInterior, [](Bytes& b) { b[b.size() - 2] = std::byte{5}; });
     },
     "F: invalid: runs_z of class 1: not a run list (run 0)"},
    {"one voxel too few",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kRimBoundary, [](ClassRuns& r) { r.pop_back(); }); },
     "F: invalid: runs_z of class 4: runs cover 8 voxels, 9 expected"},
    {"one voxel too many",
     [](RawAtlas& a) { a.edit_runs(Axis::kY, kRimBoundary, [](ClassRuns& r) { ++r.back().length; }); },
     "F: invalid: runs_y of class 4: runs cover 10 voxels, 9 expected"},
    {"runs that touch",
     [](RawAtlas& a) {
       a.edit_runs(Axis::kZ, kNeedleCrossed, [](ClassRuns& r) { r = {{15, 0, 3}, {15, 3, 3}}; });
     },
     "F: invalid: runs_z of class 7: run at 3 of scanline 15 is out of order, or not apart from the run "
     "before it"},
    {"runs that overlap",
     [](RawAtlas& a) {
       a.edit_runs(Axis::kZ, kNeedleCrossed, [](ClassRuns& r) { r = {{15, 0, 3}, {15, 2, 3}}; });
     },
     "F: invalid: runs_z of class 7: run at 2 of scanline 15 is out of order, or not apart from the run "
     "before it"},
    {"along x elsewhere",
     [](RawAtlas& a) { a.edit_runs(Axis::kX, kCoreInterior, [](ClassRuns& r) { ++r[0].scanline; }); },
     "F: invalid: runs_x and runs_z of class 1 cover different voxels"},
    {"along y elsewhere",
     [](RawAtlas& a) { a.edit_runs(Axis::kY, kCoreInterior, [](ClassRuns& r) { ++r[0].start; }); },
     "F: invalid: runs_y and runs_z of class 1 cover different voxels"},
    {"along z out of the box",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kCoreInterior, [](ClassRuns& r) { ++r[0].start; }); },
     "F: invalid: the box of class 1 does not match its runs"},
    {"along z over another class, its box moved too",
     [](RawAtlas& a) {
       a.directory.classes[kCoreInterior].box_first[0] = a.directory.classes[kCoreInterior].box_last[0] = 4;
       for (const Axis axis : kAxes) {
         a.edit_runs(axis, kCoreInterior, [](ClassRuns& r) {
           r[0].start == 2 && r[0].scanline == 7 ? r[0].start = 4 : r[0].scanline;
         });
       }
       a.edit_runs(Axis::kX, kCoreInterior, [](ClassRuns& r) { r[0].scanline += 2 * 4; });
       a.edit_runs(Axis::kY, kCoreInterior, [](ClassRuns& r) { r[0].start = 4; });
       a.edit_runs(Axis::kZ, kCoreInterior, [](ClassRuns& r) { r[0].start = 4; });
     },
     "F: invalid: runs_z of classes 1 and 4 overlap in scanline 7"},
    {"of a shared list other voxels",
     [](RawAtlas& a) { a.edit_runs(Axis::kZ, kKnobInterior, [](ClassRuns& r) { r[0].start = 5; }); },
     "F: invalid: the box of class 6 does not match its runs"},
    {"of a shared list one voxel too few",
     [](RawAtlas& a) { a.edit_runs(Axis::kX, kKnobInterior, [](ClassRuns& r) { --r.back().length; }); },
     "F: invalid: runs_x of class 5: runs cover 26 voxels, 27 expected"},
};

TEST(BadFiles, WithABadFrame) {
  expect_refused(kFrames);
}
TEST(BadFiles, WithABadRunList) {
  expect_refused(kRunLists);
}

}  // namespace
}  // namespace splatlas
