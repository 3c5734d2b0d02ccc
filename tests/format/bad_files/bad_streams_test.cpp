// Invalid files: Zstandard frames and run lists in intact chunks.

#include <gtest/gtest.h>
#include <zstd.h>

#include "format/atlas_reader.h"
#include "tests/format/bad_files/bad_files.h"
#include "tests/support/message_of.h"

namespace splatlas {
namespace {

using enum good::Class;

template <typename... Byte>
Bytes list(Byte... bytes) {
  return {static_cast<std::byte>(bytes)...};
}

// ---- Zstandard frames

Bytes compressed(std::size_t bytes) {
  Bytes frame(ZSTD_compressBound(bytes));
  const Bytes content(bytes);
  frame.resize(ZSTD_compress(frame.data(), frame.size(), content.data(), content.size(), 1));
  return frame;
}

Bytes joined(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A frame that replaces the values, fewer than 600 bytes when decoded.
struct BadFrame {
  const char* what;
  Bytes (*make)();
  const char* message;
};

constexpr BadFrame kFrames[] = {
    {"no frame", [] { return list(1, 2, 3, 4, 5); }, "not a Zstandard frame"},
    {"the magic number alone", [] { return list(0x28, 0xb5, 0x2f, 0xfd); }, "not one Zstandard frame"},
    {"a byte behind the frame", [] { return joined(compressed(300), list(0)); }, "not one Zstandard frame"},
    {"a skippable frame", [] { return list(0x50, 0x2a, 0x4d, 0x18, 4, 0, 0, 0, 1, 2, 3, 4); },
     "not a Zstandard frame"},
    {"a frame of less content", [] { return compressed(8); }, "wrong frame length (expected 487 bytes)"},
    {"a bomb of a gibibyte",
     [] {
       Bytes f = list(0x28, 0xb5, 0x2f, 0xfd, 0xa0, 0, 0, 0, 0x40);
       for (int n = 0; n < 40; ++n) f = joined(f, list(n == 39, 0, 0x10, 0));
       return f;
     },
     "not one Zstandard frame"},
    {"a frame that does not tell its content", [] { return list(0x28, 0xb5, 0x2f, 0xfd, 0, 0x58, 1, 0, 0); },
     "wrong frame length (expected 487 bytes)"},
    {"a frame that needs a dictionary",  // 487 zeros
     [] { return list(0x28, 0xb5, 0x2f, 0xfd, 0x61, 0x77, 0xe7, 0, 0x3b, 0x0f, 0, 0); },
     "its frame needs a dictionary"},
};

TEST(BadFiles, WithABadFrame) {
  expect_faults(kFrames, "F: damaged: {} of values of classes 0 to 4", [](RawAtlas& a, const BadFrame& row) {
    a.set_chunk(SectionKind::kValues, 0, row.make());
    a.chunk(SectionKind::kValues).codec = 1;
  });
}

// ---- run lists

/// The bytes or runs of a class along an axis.
template <typename Part>
struct BadList {
  const char* what;
  Axis axis;
  good::Class of_class;
  void (*change)(Part& part);
  const char* message;
};

constexpr BadList<Bytes> kRunBytes[] = {
    {"a mask of less voxels", Axis::kZ, kCoreInterior, [](auto& b) { b = list(0, 255, 255, 255); },
     "z of class 1: invalid mask"},
    {"a mask with bytes left", Axis::kZ, kCoreInterior, [](auto& b) { b = Bytes(29); },
     "z of class 1: invalid mask"},
    {"more runs than voxels", Axis::kZ, kCoreInterior, [](auto& b) { b[0] = std::byte{2}; },
     "z of class 1: run list says it has 2 runs"},
    {"bytes behind the list", Axis::kZ, kCoreInterior, [](auto& b) { b.push_back(std::byte{0}); },
     "z of class 1: trailing bytes after the run list"},
    {"one byte too few", Axis::kX, kCoreBoundary, [](auto& b) { b.pop_back(); },
     "x of class 2: not a run list (run 6)"},
    {"a start below 0", Axis::kZ, kCoreInterior, [](auto& b) { b.back() = std::byte{1}; },
     "z of class 1: not a run list (run 0)"},
};

constexpr BadList<ClassRuns> kRuns[] = {
    {"a scanline beyond all grids", Axis::kZ, kCoreInterior,
     [](auto& r) { r[0].scanline = ~std::uint64_t{0}; }, "z of class 1: not a run list (run 0)"},
    {"one voxel too few", Axis::kZ, kRimBoundary, [](auto& r) { r.pop_back(); },
     "z of class 4: runs cover 8 voxels, 9 expected"},
    {"one voxel too many", Axis::kY, kRimBoundary, [](auto& r) { ++r.back().length; },
     "y of class 4: runs cover 10 voxels, 9 expected"},
    {"of a shared list one voxel too few", Axis::kX, kKnobInterior, [](auto& r) { --r.back().length; },
     "x of class 5: runs cover 26 voxels, 27 expected"},
    {"along x elsewhere", Axis::kX, kCoreBoundary,
     [](auto& r) {
       // One voxel on either side of the interior one: the second moves there.
       const auto one_of_two = std::ranges::adjacent_find(r, {}, &Run::scanline);
       ++one_of_two->length;
       r.erase(one_of_two + 1);
     },
     "x of class 2 covers other voxels than its fingerprint"},
    {"along y elsewhere", Axis::kY, kCoreBoundary,
     [](auto& r) { std::ranges::find(r, 1u, &Run::length)->start = 2; },
     "y of class 2 covers other voxels than its fingerprint"},
};

constexpr BadList<ClassRuns> kRunsOutside[] = {
    {"a scanline beyond the grid", Axis::kZ, kCoreInterior, [](auto& r) { r[0].scanline = 20; },
     "z of class 1: run of 1 voxels at 2 of scanline 20 is not inside 20 scanlines of 10"},
    {"an end beyond the row", Axis::kZ, kRimBoundary, [](auto& r) { r[0].length = 9; },
     "z of class 4: run of 9 voxels at 4 of scanline 1 is not inside 20 scanlines of 10"},
};

constexpr BadList<ClassRuns> kRunsTogether[] = {
    {"runs that touch", Axis::kZ, kNeedleCrossed,
     [](auto& r) {
       r = ClassRuns{{15, 0, 3}, {15, 3, 3}};
     },
     "class 7: run at 3 of scanline 15"},
};

constexpr BadList<ClassRuns> kRunsOutOfBox[] = {
    {"along x", Axis::kX, kCoreInterior, [](auto& r) { ++r[0].scanline; }, "1 does not match its runs_x"},
    {"along y", Axis::kY, kCoreInterior, [](auto& r) { ++r[0].start; }, "1 does not match its runs_y"},
    {"along z", Axis::kZ, kCoreInterior, [](auto& r) { ++r[0].start; }, "1 does not match its runs_z"},
    {"of a shared list", Axis::kZ, kKnobInterior, [](auto& r) { r[0].start = 5; },
     "6 does not match its runs_z"},
};

TEST(BadFiles, WithABadRunList) {
  const auto edit_runs = [](RawAtlas& a, const auto& row) {
    a.edit_runs(row.axis, row.of_class, row.change);
  };
  expect_faults(kRunBytes, "F: invalid: runs_{}", [](RawAtlas& a, const auto& row) {
    a.edit_stream(run_section(row.axis), row.of_class, row.change);
  });
  expect_faults(kRuns, "F: invalid: runs_{}", edit_runs);
  expect_faults(kRunsOutside, "F: invalid: runs_{} voxels", edit_runs);
  expect_faults(kRunsTogether,
                "F: invalid: runs_z of {} is out of order, or not apart from the run before it", edit_runs);
  expect_faults(kRunsOutOfBox, "F: invalid: the box of class {}", edit_runs);
}

/// Also without verify(): of other voxels, no picture is drawn.
TEST(BadFiles, WithOtherRunsAreNotRead) {
  const auto fault_of_runs = [](const RawAtlas& atlas, good::Class c, Axis axis) {
    return message_of(Atlas::open_bytes(file_of(atlas), "F").value()->read_runs(c, axis));
  };
  for (const auto& row : kRuns) {
    RawAtlas atlas = raw_atlas(good_file());
    atlas.edit_runs(row.axis, row.of_class, row.change);
    EXPECT_EQ(fault_of_runs(atlas, row.of_class, row.axis), std::string("F: invalid: runs_") + row.message);
  }
  RawAtlas atlas = raw_atlas(good_file());
  std::swap(atlas.directory.fingerprints[1], atlas.directory.fingerprints[3]);
  EXPECT_EQ(fault_of_runs(atlas, kCoreInterior, Axis::kZ),
            "F: invalid: runs_z of class 1 covers other voxels than its fingerprint");
}

}  // namespace
}  // namespace splatlas
