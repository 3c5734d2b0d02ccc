// Invalid files: classes, their memberships, boxes and lengths.
#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

using enum good::Class;

constexpr BadFile kMembers[] = {
    {"members of class 0", [](RawAtlas& a) { a.directory.classes[0].members_end = 1; },
     "F: invalid: class 0 repeats another class"},
    {"a structure that is not there", [](RawAtlas& a) { a.directory.members[0] = 5 * 4; },
     "F: invalid: class 1 has part 0 of structure 5"},
    {"the largest structure", [](RawAtlas& a) { a.directory.members[0] = 0xfffffffc; },
     "F: invalid: class 1 has part 0 of structure 1073741823"},
    {"part 3", [](RawAtlas& a) { a.directory.members[0] = good::kCore * 4 + 3; },
     "F: invalid: class 1 has part 3 of structure 1"},
    {"a structure twice", [](RawAtlas& a) { a.directory.members[3] = a.directory.members[2]; },
     "F: invalid: memberships of class 3 are not in order"},
    {"a structure in two parts", [](RawAtlas& a) { a.directory.members[3] = good::kCore * 4 + 2; },
     "F: invalid: memberships of class 3 are not in order"},
    {"memberships out of order",
     [](RawAtlas& a) { std::swap(a.directory.members[2], a.directory.members[3]); },
     "F: invalid: memberships of class 3 are not in order"},
    {"a class twice", [](RawAtlas& a) { a.directory.members[1] = good::kCore * 4; },
     "F: invalid: class 2 repeats another class"},
    {"the empty class twice", [](RawAtlas& a) { a.directory.classes[1].members_end = 0; },
     "F: invalid: class 1 repeats another class"},
    {"ends of members that fall", [](RawAtlas& a) { a.directory.classes[3].members_end = 1; },
     "F: invalid: inconsistent offsets of directory table of class members"},
    {"an end of members beyond them", [](RawAtlas& a) { ++a.directory.classes.back().members_end; },
     "F: invalid: inconsistent offsets of directory table of class members"},
    {"the largest end of members", [](RawAtlas& a) { a.directory.classes[2].members_end = 0xffffffff; },
     "F: invalid: inconsistent offsets of directory table of class members"},
    {"one membership too many", [](RawAtlas& a) { a.directory.members.push_back(0); },
     "F: invalid: inconsistent offsets of directory table of class members"},
    {"one membership too few", [](RawAtlas& a) { a.directory.members.pop_back(); },
     "F: invalid: inconsistent offsets of directory table of class members"},
    {"no classes",
     [](RawAtlas& a) {
       a.directory.classes.clear();
       a.directory.members.clear();
     },
     "F: invalid: 5 structures (limit 1048576) and 0 classes (1 to 16777216)"},
    {"one class too few",
     [](RawAtlas& a) {
       a.directory.classes.pop_back();
       a.directory.members.pop_back();
       a.directory.normals_fitted.pop_back();
     },
     "F: invalid: classes have 194 voxels, the grid has 200"},
    {"two classes exchanged",
     [](RawAtlas& a) {
       std::swap(a.directory.classes[kRimBoundary], a.directory.classes[kNeedleCrossed]);
       std::swap(a.directory.classes[kRimBoundary].members_end,
                 a.directory.classes[kNeedleCrossed].members_end);
       std::swap(a.directory.members[4], a.directory.members[7]);
     },
     "F: damaged: wrong frame length (expected 484 bytes) of values of classes 0 to 4"},
};

constexpr BadFile kVoxels[] = {
    {"one voxel more", [](RawAtlas& a) { ++a.directory.classes[0].voxels; },
     "F: invalid: classes have more voxels than the grid's 200"},
    {"one voxel less", [](RawAtlas& a) { --a.directory.classes[0].voxels; },
     "F: invalid: classes have 199 voxels, the grid has 200"},
    {"2^64 - 1 voxels", [](RawAtlas& a) { a.directory.classes[0].voxels = ~std::uint64_t{0}; },
     "F: invalid: classes have more voxels than the grid's 200"},
    {"counts that wrap around to the right sum",
     [](RawAtlas& a) {
       a.directory.classes[0].voxels += std::uint64_t{1} << 63;
       a.directory.classes[1].voxels += std::uint64_t{1} << 63;
     },
     "F: invalid: classes have more voxels than the grid's 200"},
    {"a voxel moved to another class",
     [](RawAtlas& a) {
       --a.directory.classes[kCoreBoundary].voxels;
       ++a.directory.classes[kRimBoundary].voxels;
     },
     "F: invalid: box of class 4 does not fit its 10 voxels in the grid"},
    {"a voxel moved to a class without room",
     [](RawAtlas& a) {
       ++a.directory.classes[kCoreInterior].voxels;
       --a.directory.classes[0].voxels;
     },
     "F: invalid: box of class 1 does not fit its 2 voxels in the grid"},
    {"a class without voxels but with a box",
     [](RawAtlas& a) {
       a.directory.classes[0].voxels += 6;
       a.directory.classes[kNeedleCrossed].voxels = 0;
     },
     "F: invalid: box of class 7 does not fit its 0 voxels in the grid"},
    {"a voxel moved within a shared list",
     [](RawAtlas& a) {
       a.directory.classes[kKnobInterior].voxels = 2;
       a.directory.classes[kKnobBoundary].voxels = 25;
       a.directory.classes[kKnobInterior].box_last = {8, 2, 1};
     },
     "F: invalid: runs_z of class 5: 1 voxels are interior to classes 5 and 6, expected 2"},
};

constexpr BadFile kBoxes[] = {
    {"begins before x", [](RawAtlas& a) { a.directory.classes[1].box_first[0] = -1; },
     "F: invalid: box of class 1 does not fit its 1 voxels in the grid"},
    {"begins before y", [](RawAtlas& a) { a.directory.classes[2].box_first[1] = -1; },
     "F: invalid: box of class 2 does not fit its 17 voxels in the grid"},
    {"begins at the minimum z", [](RawAtlas& a) { a.directory.classes[3].box_first[2] = -0x7fffffff - 1; },
     "F: invalid: box of class 3 does not fit its 9 voxels in the grid"},
    {"ends beyond x", [](RawAtlas& a) { a.directory.classes[4].box_last[0] = 10; },
     "F: invalid: box of class 4 does not fit its 9 voxels in the grid"},
    {"ends beyond y", [](RawAtlas& a) { a.directory.classes[5].box_last[1] = 5; },
     "F: invalid: box of class 5 does not fit its 1 voxels in the grid"},
    {"ends at the largest z", [](RawAtlas& a) { a.directory.classes[6].box_last[2] = 0x7fffffff; },
     "F: invalid: box of class 6 does not fit its 26 voxels in the grid"},
    {"ends before it begins", [](RawAtlas& a) { a.directory.classes[7].box_last[0] = -1; },
     "F: invalid: box of class 7 does not fit its 6 voxels in the grid"},
    {"the wrong way round along y",
     [](RawAtlas& a) { std::swap(a.directory.classes[2].box_first[1], a.directory.classes[2].box_last[1]); },
     "F: invalid: box of class 2 does not fit its 17 voxels in the grid"},
    {"too small for the voxels", [](RawAtlas& a) { a.directory.classes[7].box_last[0] = 4; },
     "F: invalid: box of class 7 does not fit its 6 voxels in the grid"},
    {"none, with voxels",
     [](RawAtlas& a) {
       a.directory.classes[1].box_first = {0, 0, 0};
       a.directory.classes[1].box_last = {-1, -1, -1};
     },
     "F: invalid: box of class 1 does not fit its 1 voxels in the grid"},
    {"of the empty class beyond the grid", [](RawAtlas& a) { a.directory.classes[0].box_last[0] = 10; },
     "F: invalid: box of class 0 does not fit its 131 voxels in the grid"},
    {"not tight", [](RawAtlas& a) { a.directory.classes[1].box_last[0] = 9; },
     "F: invalid: the box of class 1 does not match its runs"},
    {"elsewhere",
     [](RawAtlas& a) {
       a.directory.classes[1].box_first = {0, 0, 0};
       a.directory.classes[1].box_last = {0, 0, 0};
     },
     "F: invalid: the box of class 1 does not match its runs"},
    {"of a stored normal's class not tight",
     [](RawAtlas& a) { a.directory.classes[kCoreAndRim].box_last[0] = 9; },
     "F: invalid: the box of class 3 does not match its runs"},
    {"none for the empty class, which may be",
     [](RawAtlas& a) {
       a.directory.classes[0].box_first = {0, 0, 0};
       a.directory.classes[0].box_last = {-1, -1, -1};
     },
     ""},
};

constexpr BadFile kRunBytes[] = {
    {"a list of class 0 along x", [](RawAtlas& a) { a.directory.classes[0].run_bytes[0] = 4; },
     "F: invalid: runs of class 0 along axis 0 take 4 bytes for 0 voxels"},
    {"a list of class 0 along z", [](RawAtlas& a) { a.directory.classes[0].run_bytes[2] = 4; },
     "F: invalid: runs of class 0 along axis 2 take 4 bytes for 0 voxels"},
    {"no list along x", [](RawAtlas& a) { a.directory.classes[1].run_bytes[0] = 0; },
     "F: invalid: runs of class 1 along axis 0 take 0 bytes for 1 voxels"},
    {"no list along y", [](RawAtlas& a) { a.directory.classes[2].run_bytes[1] = 0; },
     "F: invalid: runs of class 2 along axis 1 take 0 bytes for 17 voxels"},
    {"no list along z", [](RawAtlas& a) { a.directory.classes[3].run_bytes[2] = 0; },
     "F: invalid: runs of class 3 along axis 2 take 0 bytes for 9 voxels"},
    {"a list too short for a run", [](RawAtlas& a) { a.directory.classes[1].run_bytes[0] = 3; },
     "F: invalid: runs of class 1 along axis 0 take 3 bytes for 1 voxels"},
    {"a list too long for its voxels", [](RawAtlas& a) { a.directory.classes[1].run_bytes[1] = 31; },
     "F: invalid: runs of class 1 along axis 1 take 31 bytes for 1 voxels"},
    {"the longest list", [](RawAtlas& a) { a.directory.classes[7].run_bytes[2] = 0xffffffff; },
     "F: invalid: runs of class 7 along axis 2 take 4294967295 bytes for 6 voxels"},
    {"a list one byte longer", [](RawAtlas& a) { ++a.directory.classes[2].run_bytes[0]; },
     "F: damaged: wrong frame length (expected 94 bytes) of runs_x of classes 1 to 7"},
    {"a list one byte shorter", [](RawAtlas& a) { --a.directory.classes[2].run_bytes[0]; },
     "F: damaged: wrong frame length (expected 92 bytes) of runs_x of classes 1 to 7"},
    {"a byte moved to the next list",
     [](RawAtlas& a) {
       ++a.directory.classes[2].run_bytes[2];
       --a.directory.classes[3].run_bytes[2];
     },
     "F: invalid: runs_z of class 2: trailing bytes after the run list"},
    {"a list for the second class of a shared one",
     [](RawAtlas& a) { a.directory.classes[kKnobBoundary].run_bytes[0] = 4; },
     "F: damaged: wrong frame length (expected 97 bytes) of runs_x of classes 1 to 7"},
    {"one list for classes that may share none",
     [](RawAtlas& a) {
       a.directory.classes[kCoreInterior].run_bytes[2] += a.directory.classes[kCoreBoundary].run_bytes[2];
       a.directory.classes[kCoreBoundary].run_bytes[2] = 0;
     },
     "F: invalid: runs of class 1 along axis 2 take 32 bytes for 1 voxels"},
};

constexpr BadFile kTotals[] = {
    {"more runs along x than voxels", [](RawAtlas& a) { a.directory.run_totals[0] = 70; },
     "F: invalid: run model 0 has 70 runs of 69 voxels"},
    {"more runs along y than voxels", [](RawAtlas& a) { a.directory.run_totals[1] = ~std::uint64_t{0}; },
     "F: invalid: run model 1 has 18446744073709551615 runs of 69 voxels"},
    {"more runs along z than voxels", [](RawAtlas& a) { a.directory.run_totals[2] = 1u << 31; },
     "F: invalid: run model 2 has 2147483648 runs of 69 voxels"},
    {"one run along x less", [](RawAtlas& a) { --a.directory.run_totals[0]; },
     "F: invalid: runs_x has 31 runs, the directory says 30"},
    {"one run along y more", [](RawAtlas& a) { ++a.directory.run_totals[1]; },
     "F: invalid: runs_y has 40 runs, the directory says 41"},
    {"no runs along z", [](RawAtlas& a) { a.directory.run_totals[2] = 0; },
     "F: invalid: runs_z has 40 runs, the directory says 0"},
};

constexpr BadFile kNormalsFitted[] = {
    {"of one class too few", [](RawAtlas& a) { a.directory.normals_fitted.pop_back(); },
     "F: invalid: normals of 7 classes, there are 8"},
    {"of one class too many", [](RawAtlas& a) { a.directory.normals_fitted.push_back(0); },
     "F: invalid: normals of 9 classes, there are 8"},
    {"of no classes", [](RawAtlas& a) { a.directory.normals_fitted.clear(); },
     "F: invalid: normals of 0 classes, there are 8"},
    {"for the empty class", [](RawAtlas& a) { a.directory.normals_fitted[0] = 1; },
     "F: invalid: class 0 has fitted normals but no boundary"},
    {"for an interior", [](RawAtlas& a) { a.directory.normals_fitted[kKnobInterior] = 1; },
     "F: invalid: class 5 has fitted normals but no boundary"},
    {"for a crossed class", [](RawAtlas& a) { a.directory.normals_fitted[kNeedleCrossed] = 1; },
     "F: invalid: class 7 has fitted normals but no boundary"},
    {"2 for a boundary", [](RawAtlas& a) { a.directory.normals_fitted[kKnobBoundary] = 2; },
     "F: invalid: normals of class 6 are fitted by 2"},
    {"255 for a class that stores them", [](RawAtlas& a) { a.directory.normals_fitted[kCoreBoundary] = 255; },
     "F: invalid: normals of class 2 are fitted by 255"},
    {"for a class that stores them", [](RawAtlas& a) { a.directory.normals_fitted[kCoreBoundary] = 1; },
     "F: invalid: chunk 0 of section normals stores 36 bytes as 70"},
    {"not for a class that does not", [](RawAtlas& a) { a.directory.normals_fitted[kKnobBoundary] = 0; },
     "F: damaged: 70 bytes, expected 122 of normals of classes 2 to 6"},
};

TEST(BadFiles, WithABadMembership) {
  expect_refused(kMembers);
}
TEST(BadFiles, WithABadCountOfVoxels) {
  expect_refused(kVoxels);
}
TEST(BadFiles, WithABadBox) {
  expect_refused(kBoxes);
}
TEST(BadFiles, WithABadLengthOfRuns) {
  expect_refused(kRunBytes);
}
TEST(BadFiles, WithABadNumberOfRuns) {
  expect_refused(kTotals);
}
TEST(BadFiles, WithABadFlagForNormals) {
  expect_refused(kNormalsFitted);
}

}  // namespace
}  // namespace splatlas
