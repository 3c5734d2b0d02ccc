// Fuzz target: untrusted codes of grey values, decoded or refused; round trips of any values.
// Input: width, height, depth and a byte of choices; a number of runs and their lengths, in voxels
// alternately outside and inside the group; then the code or the values.
#include <cstdint>
#include <vector>

#include "format/codec/value_codec.h"
#include "format/content/run_model.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

constexpr std::size_t kMaxGroupSide = 12;

/// The rest of `bytes`, truncated or padded with zeros.
std::vector<std::byte> bytes_of_length(std::span<const std::byte> bytes, std::size_t length) {
  std::vector<std::byte> result(bytes.begin(), bytes.end());
  result.resize(length);
  return result;
}

std::vector<ClassId> read_mask(FuzzInput& input, std::size_t voxels) {
  std::vector<ClassId> mask;
  for (std::size_t n = input.below(64), stretch = 0; stretch < n; ++stretch)
    mask.insert(mask.end(), input.below(256), static_cast<ClassId>(stretch % 2));
  mask.resize(voxels, 1);
  return mask;
}

/// The group of all voxels of class 1. `spans` owns its spans.
GroupVoxels group_of(const std::vector<ClassId>& mask, const Index3& size, std::vector<ClassSpan>& spans) {
  GroupVoxels group;
  group.rows = size[1];
  const RunModel model = encode_runs(mask, size, Axis::kZ, 2);
  for (const Run& run : model.classes[1]) {
    spans.push_back({run, 1});
    const auto scanline = static_cast<std::int64_t>(run.scanline);
    const std::int64_t j = scanline % size[1], k = scanline / size[1];
    group.box.include(IndexBox{{run.start, j, k}, {std::int64_t{run.start} + run.length - 1, j, k}});
    group.voxels += run.length;
  }
  group.spans = spans;
  return group;
}

void check_round_trip(const GroupVoxels& group, VoxelType type, const std::vector<std::byte>& values) {
  const auto code = encode_values(group, type, values);
  require(code.size() == value_code_bytes(type, group.box, group.voxels),
          "a code of another length than is told");
  require(require_value(decode_values(group, type, code)) == values, "values decode to others");
}

void fuzz_values(FuzzInput input) {
  Index3 size{};
  for (std::int64_t& n : size) n = 1 + static_cast<std::int64_t>(input.below(kMaxGroupSide));
  const auto choices = input.number<std::uint8_t>();
  const auto type = static_cast<VoxelType>(1 + choices % 8);
  const auto mask = read_mask(input, static_cast<std::size_t>(size[0] * size[1] * size[2]));
  std::vector<ClassSpan> spans;
  const GroupVoxels group = group_of(mask, size, spans);
  if (group.voxels == 0) return;
  const std::size_t value_bytes = group.voxels * bytes_of(type);
  if (choices >= 0x80) return check_round_trip(group, type, bytes_of_length(input.rest(), value_bytes));

  const auto code = bytes_of_length(input.rest(), value_code_bytes(type, group.box, group.voxels));
  const auto values = decode_values(group, type, code);
  if (!values) return require_error(values.error(), {ErrorCode::kInvalidAtlas});
  require(values->size() == value_bytes, "as many values as voxels");
  check_round_trip(group, type, *values);
}

const FuzzTarget kValues("values", fuzz_values);

}  // namespace
}  // namespace splatlas
