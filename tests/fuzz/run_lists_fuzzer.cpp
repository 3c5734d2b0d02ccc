// Fuzz target: untrusted run lists; operations on valid ones, checked voxel by voxel.
// Input: width, height and depth (a byte each), a byte of choices, then an encoded list, or the number of
// voxels of a mask and its code, or voxels as bits.
#include <cstdint>
#include <vector>

#include "format/codec/mask_codec.h"
#include "format/codec/run_codec.h"
#include "format/content/run_model.h"
#include "format/derive/boundary_split.h"
#include "format/derive/run_fingerprint.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"
#include "tests/support/neighbours.h"

namespace splatlas {
namespace {

constexpr std::size_t kMaxVoxelsASide = 12;

IndexBox box_of(const ClassRuns& runs, const Index3& size, Axis axis) {
  const ScanOrder order = ScanOrder::of(axis);
  IndexBox box;
  for (const Run& run : runs) {
    const auto scanline = static_cast<std::int64_t>(run.scanline);
    Index3 first{};
    first[order.row_axis] = scanline % size[order.row_axis];
    first[order.slice_axis] = scanline / size[order.row_axis];
    first[order.scan_axis] = run.start;
    Index3 last = first;
    last[order.scan_axis] += run.length - std::int64_t{1};
    box.include(IndexBox{first, last});
  }
  return box;
}

void check_mask(const ClassRuns& runs, const Index3& size, Axis axis, std::uint64_t voxels) {
  const IndexBox box = box_of(runs, size, axis);
  if (!codes_mask(box, voxels)) return;
  const std::vector<std::byte> code = encode_mask(runs, box, size, axis);
  require(require_value(decode_mask(code, box, size, axis, voxels)) == runs, "a mask decodes to another one");
}

void check_code(const ClassRuns& runs, std::uint64_t voxels) {
  std::vector<std::byte> code;
  append_run_list(runs, code);
  require(code.size() >= min_run_list_bytes(voxels) && code.size() <= max_run_list_bytes(voxels),
          "a list's code is longer or shorter than its bounds");
  require(require_value(decode_run_list(code, voxels)) == runs, "a list decodes to another one");
}

/// Requires valid runs along scanlines of principal axis `axis`.
void check_valid_runs(const ClassRuns& runs, const Index3& size, Axis axis) {
  const std::vector<ClassId> mask = require_value(decode_runs({axis, {{}, runs}}, size));
  const std::vector<ClassId> parts = split_by_definition(mask, size);
  const RunFingerprinter fingerprinter(size);
  for (const Axis other : kAxes) {
    const ClassRuns expected = encode_runs(mask, size, other, 2).classes[1];
    const ClassRuns converted = convert_runs(runs, size, axis, other);
    require(converted == expected, "converted runs cover other voxels");
    require(fingerprinter.of(converted, other) == fingerprinter.of(runs, axis), "fingerprints differ");
    const RunModel by_definition = encode_runs(parts, size, other, 3);
    const SplitRuns split = split_boundary(converted, size, other);
    require(split.interior == by_definition.classes[1] && split.boundary == by_definition.classes[2],
            "boundary split at other voxels");
    require(join_runs(split.interior, split.boundary) == converted, "split runs join to others");
  }
}

/// One bit per voxel.
std::vector<ClassId> mask_of(std::span<const std::byte> bits, std::size_t voxels) {
  std::vector<ClassId> mask(voxels, 0);
  for (std::size_t v = 0; v < voxels && v / 8 < bits.size(); ++v) {
    mask[v] = std::to_integer<ClassId>(bits[v / 8] >> (v % 8) & std::byte{1});
  }
  return mask;
}

void fuzz_run_lists(FuzzInput input) {
  Index3 size{};
  for (std::int64_t& n : size) n = 1 + static_cast<std::int64_t>(input.below(kMaxVoxelsASide));
  const auto choices = input.number<std::uint8_t>();
  const Axis axis = kAxes[choices % 3];
  const auto voxels = static_cast<std::uint64_t>(size[0] * size[1] * size[2]);

  ClassRuns runs;
  if (choices >= 0x80) {
    runs = encode_runs(mask_of(input.rest(), voxels), size, axis, 2).classes[1];
  } else if (choices >= 0x40) {
    const IndexBox grid{{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
    const std::uint64_t of_mask = 1 + input.below(voxels);
    auto decoded = decode_mask(input.rest(), grid, size, axis, of_mask);
    if (!decoded) return require_error(decoded.error(), {ErrorCode::kInvalidAtlas});
    runs = std::move(*decoded);
    require(validate_runs(runs, size, axis, of_mask).has_value(), "a mask of other voxels is taken");
  } else {
    auto decoded = decode_run_list(input.rest(), voxels);
    if (!decoded) return require_error(decoded.error(), {ErrorCode::kInvalidAtlas});
    runs = std::move(*decoded);
  }
  std::uint64_t covered = 0;
  for (const Run& run : runs) covered += run.length;
  if (const auto valid = validate_runs(runs, size, axis, covered); !valid) {
    require(choices < 0x80, "encoded runs are not valid");
    require_error(valid.error(), {ErrorCode::kInvalidAtlas});
    return;
  }
  require(!validate_runs(runs, size, axis, covered + 1), "runs of one voxel less are valid");
  check_code(runs, covered);
  check_mask(runs, size, axis, covered);
  check_valid_runs(runs, size, axis);
}

const FuzzTarget kRunLists("run_lists", fuzz_run_lists);

}  // namespace
}  // namespace splatlas
