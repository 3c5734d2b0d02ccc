// Invalid files: classes, their memberships, boxes and lengths.
#include <utility>

#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

using enum good::Class;
using BadDirectory = BadFile<RawDirectory>;

constexpr BadPart<RawDirectory> kMembers[] = {
    {[](auto& d) { d.classes[0].members_end = 1; }, "class 0 repeats another class"},
    {[](auto& d) { d.members[0] = 5 * 4; }, "class 1 has part 0 of structure 5"},
    {[](auto& d) { d.members[0] = good::kCore * 4 + 3; }, "class 1 has part 3 of structure 1"},
    {[](auto& d) { d.members[3] = d.members[2]; }, "memberships of class 3 are not in order"},
    {[](auto& d) { d.members[3] = good::kCore * 4 + 2; }, "memberships of class 3 are not in order"},
    {[](auto& d) { std::swap(d.members[2], d.members[3]); }, "memberships of class 3 are not in order"},
    {[](auto& d) { d.members[1] = good::kCore * 4; }, "class 2 repeats another class"},
    {[](auto& d) { d.classes.clear(), d.members.clear(); },
     "5 structures (limit 1048576) and 0 classes (1 to 16777216)"},
    {[](auto& d) { d.classes.pop_back(), d.members.pop_back(), d.normals_fitted.pop_back(); },
     "classes have 194 voxels, the grid has 200"},
};

constexpr BadDirectory kEndsOfMembers[] = {
    {"that fall", [](auto& d) { d.classes[3].members_end = 1; }},
    {"beyond the members", [](auto& d) { ++d.classes.back().members_end; }},
    {"one membership too many", [](auto& d) { d.members.push_back(0); }},
};

constexpr BadDirectory kVoxels[] = {
    {"one more", [](auto& d) { ++d.classes[0].voxels; }, "classes have more voxels than the grid's 200"},
    {"one less", [](auto& d) { --d.classes[0].voxels; }, "classes have 199 voxels, the grid has 200"},
    {"counts that wrap around to the right sum",
     [](auto& d) {
       for (const ClassId c : {0u, 1u}) d.classes[c].voxels += std::uint64_t{1} << 63;
     },
     "classes have more voxels than the grid's 200"},
    {"one moved to another class",
     [](auto& d) { --d.classes[kCoreBoundary].voxels, ++d.classes[kRimBoundary].voxels; },
     "box of class 4 does not fit its 10 voxels in the grid"},
    {"none in a class with a box",
     [](auto& d) { d.classes[0].voxels += 6, d.classes[kNeedleCrossed].voxels = 0; },
     "box of class 7 does not fit its 0 voxels in the grid"},
    {"one moved within a shared list",
     [](auto& d) {
       d.classes[kKnobInterior].voxels = 2;
       d.classes[kKnobBoundary].voxels = 25;
       d.classes[kKnobInterior].box_last = {8, 2, 1};
     },
     "runs_z of class 5: 1 voxels are interior to classes 5 and 6, expected 2"},
};

/// The class has no box.
constexpr void clear_box(RawClass& c) {
  c.box_first = {0, 0, 0};
  c.box_last = {-1, -1, -1};
}

/// Moves all voxels of the class to the empty class.
constexpr RawClass& leave_without_voxels(RawDirectory& d, ClassId c) {
  RawClass& row = d.classes[c];
  d.classes[0].voxels += std::exchange(row.voxels, 0);
  clear_box(row);
  row.run_bytes = {};
  return row;
}

constexpr BadPart<RawDirectory> kBoxes[] = {
    {[](auto& d) { d.classes[1].box_first[0] = -1; }, "class 1 does not fit its 1"},
    {[](auto& d) { d.classes[2].box_first[1] = -1; }, "class 2 does not fit its 17"},
    {[](auto& d) { d.classes[3].box_first[2] = -0x7fffffff - 1; }, "class 3 does not fit its 9"},
    {[](auto& d) { d.classes[4].box_last[0] = 10; }, "class 4 does not fit its 9"},
    {[](auto& d) { d.classes[5].box_last[1] = 5; }, "class 5 does not fit its 1"},
    {[](auto& d) { d.classes[6].box_last[2] = 0x7fffffff; }, "class 6 does not fit its 26"},
    {[](auto& d) { clear_box(d.classes[1]); }, "class 1 does not fit its 1"},
};

constexpr BadPart<RawDirectory> kEmptyBoxes[] = {
    {[](auto& d) { d.classes[0].box_first[0] = 251; }, "0"},
    {[](auto& d) { leave_without_voxels(d, kNeedleCrossed).box_last[0] = -2; }, "7"},
    {[](auto& d) { leave_without_voxels(d, kNeedleCrossed).box_first[2] = 1; }, "7"},
};

constexpr BadPart<RawDirectory> kOtherBoxes[] = {
    {[](auto& d) { d.classes[1].box_last[0] = 9; }, "class 1"},
    {[](auto& d) { d.classes[kCoreAndRim].box_last[0] = 9; }, "class 3"},
};

constexpr BadPart<RawDirectory> kRunBytes[] = {
    {[](auto& d) { d.classes[0].run_bytes[0] = 4; }, "class 0 along axis 0 take 4 bytes for 0"},
    {[](auto& d) { d.classes[1].run_bytes[0] = 0; }, "class 1 along axis 0 take 0 bytes for 1"},
    {[](auto& d) { d.classes[3].run_bytes[2] = 0; }, "class 3 along axis 2 take 0 bytes for 9"},
    {[](auto& d) { d.classes[1].run_bytes[0] = 3; }, "class 1 along axis 0 take 3 bytes for 1"},
    {[](auto& d) { d.classes[1].run_bytes[1] = 31; }, "class 1 along axis 1 take 31 bytes for 1"},
};

constexpr BadPart<RawDirectory> kTotals[] = {
    {[](auto& d) { d.run_totals[0] = 70; }, "0 has 70"},
    {[](auto& d) { d.run_totals[1] = ~std::uint64_t{0}; }, "1 has 18446744073709551615"},
};

constexpr BadPart<RawDirectory> kOtherTotals[] = {
    {[](auto& d) { --d.run_totals[0]; }, "x has more than the 30 runs that the directory states"},
    {[](auto& d) { ++d.run_totals[1]; }, "y has 40 runs, the directory says 41"},
};

using Flags = std::vector<std::uint8_t>;
constexpr BadPart<Flags> kNormalsFitted[] = {
    {[](auto& f) { f.pop_back(); }, "normals of 7 classes, there are 8"},
    {[](auto& f) { f.push_back(0); }, "normals of 9 classes, there are 8"},
    {[](auto& f) { f[0] = 1; }, "class 0 has fitted normals but no boundary"},
    {[](auto& f) { f[kKnobInterior] = 1; }, "class 5 has fitted normals but no boundary"},
    {[](auto& f) { f[kNeedleCrossed] = 1; }, "class 7 has fitted normals but no boundary"},
    {[](auto& f) { f[kKnobBoundary] = 2; }, "normals of class 6 are fitted by 2"},
    {[](auto& f) { f[kCoreBoundary] = 1; }, "chunk 0 of section normals stores 36 bytes as 70"},
};

/// Valid directories of other chunks.
constexpr BadDirectory kOtherLengths[] = {
    {"a list one byte longer", [](auto& d) { ++d.classes[2].run_bytes[0]; },
     "wrong frame length (expected 94 bytes) of runs_x of classes 1 to 7"},
    {"a list for the second class of a shared one",
     [](auto& d) { d.classes[kKnobBoundary].run_bytes[0] = 4; },
     "wrong frame length (expected 97 bytes) of runs_x of classes 1 to 7"},
    {"no fitted normals for a class that stores none", [](auto& d) { d.normals_fitted[kKnobBoundary] = 0; },
     "70 bytes, expected 122 of normals of classes 2 to 6"},
};

constexpr BadDirectory kValid[] = {
    {"no box of the empty class", [](auto& d) { clear_box(d.classes[0]); }},
};

constexpr BadPart<RawDirectory> kFingerprintsWithoutVoxels[] = {
    {[](auto& d) { leave_without_voxels(d, kNeedleCrossed), d.fingerprints[kNeedleCrossed] = 1; },
     "fingerprint 1 of class 7"},
};

constexpr BadPart<std::vector<std::uint64_t>> kFingerprints[] = {
    {[](auto& f) { f.pop_back(); }, "invalid: 7 fingerprints of 8 classes"},
    {[](auto& f) { f[1] = (std::uint64_t{1} << 61) - 1; },
     "invalid: fingerprint 2305843009213693951 of class 1"},
    {[](auto& f) { f[1] ^= 1; }, "invalid: fingerprints of classes do not add up to that of the grid"},
    {[](auto& f) { std::swap(f[1], f[3]); },
     "invalid: runs_z of class 1 covers other voxels than its fingerprint"},
    {[](auto& f) { std::swap(f[5], f[6]); },
     "invalid: runs_z of class 5 covers other voxels than its fingerprint"},
};

TEST(BadFiles, WithABadFingerprint) {
  expect_faults(kFingerprints, "F: {}", in_part(&RawDirectory::fingerprints));
  expect_faults(kFingerprintsWithoutVoxels, "F: invalid: {}, which has no voxels", in_directory);
}

TEST(BadFiles, WithABadMembership) {
  expect_faults(kMembers, "F: invalid: {}", in_directory);
  expect_faults(kEndsOfMembers, "F: invalid: inconsistent offsets of directory table of class members",
                in_directory);
}

TEST(BadFiles, WithABadClass) {
  expect_faults(kVoxels, "F: invalid: {}", in_directory);
  expect_faults(kBoxes, "F: invalid: box of {} voxels in the grid", in_directory);
  expect_faults(kEmptyBoxes, "F: invalid: empty box of class {}: must be (0, 0, 0) to (-1, -1, -1)",
                in_directory);
  expect_faults(kOtherBoxes, "F: invalid: the box of {} does not match its runs_z", in_directory);
  expect_faults(kOtherLengths, "F: damaged: {}", in_directory);
  expect_faults(kValid, "", in_directory);
}

TEST(BadFiles, WithABadLengthOrNumberOfRuns) {
  expect_faults(kRunBytes, "F: invalid: runs of {} voxels", in_directory);
  expect_faults(kTotals, "F: invalid: run model {} runs of 69 voxels", in_directory);
  expect_faults(kOtherTotals, "F: invalid: runs_{}", in_directory);
}

TEST(BadFiles, WithABadFlagForNormals) {
  expect_faults(kNormalsFitted, "F: invalid: {}", in_part(&RawDirectory::normals_fitted));
}

}  // namespace
}  // namespace splatlas
