#include "format/codec/mask_codec.h"

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/codec/run_codec.h"
#include "tests/format/random_volume.h"
#include "tests/support/neighbours.h"

namespace splatlas {
namespace {

/// A mask in a grid: bounding box and runs along an axis.
struct Shape {
  Index3 size;
  Axis axis;
  ClassRuns runs;
  IndexBox box;
  std::uint64_t voxels = 0;
};

template <typename Covers>
Shape shape_of(const Index3& size, Axis axis, Covers&& covers) {
  std::vector<ClassId> volume;
  Shape shape{size, axis, {}, {}, 0};
  for_each_voxel(size, [&](const Index3& at) {
    volume.push_back(covers(at[0], at[1], at[2]) ? 1 : 0);
    if (volume.back() == 0) return;
    shape.box.include({at, at});
    ++shape.voxels;
  });
  shape.runs = encode_runs(volume, size, axis, 2).classes[1];
  return shape;
}

std::vector<std::byte> encode(const Shape& shape) {
  return encode_mask(shape.runs, shape.box, shape.size, shape.axis);
}
Result<ClassRuns> decode(const Shape& shape, std::span<const std::byte> bytes) {
  return decode_mask(bytes, shape.box, shape.size, shape.axis, shape.voxels);
}

/// Mostly covered.
Shape random_shape(std::mt19937& random) {
  const Index3 size{1 + static_cast<std::int64_t>(random() % 20), 1 + static_cast<std::int64_t>(random() % 9),
                    1 + static_cast<std::int64_t>(random() % 9)};
  const auto holes = 1 + random() % 5;
  return shape_of(size, kAxes[random() % 3], [&](auto i, auto j, auto k) {
    return (i == 0 && j == 0 && k == 0) || random() % 6 >= holes;
  });
}

RC_GTEST_PROP(MaskCodec, GivesRunsBackAlongEveryAxis, ()) {
  auto random = *random_source();
  const Shape shape = random_shape(random);
  RC_PRE(codes_mask(shape.box, shape.voxels));
  const std::vector<std::byte> bytes = encode(shape);
  RC_ASSERT(bytes.front() == kMaskMark);
  RC_ASSERT(decode(shape, bytes).value() == shape.runs);
}

RC_GTEST_PROP(MaskCodec, RefusesOtherBytesOrGivesRunsOfItsVoxels, ()) {
  auto random = *random_source();
  const Shape shape = random_shape(random);
  std::vector<std::byte> bytes = encode(shape);
  if (bytes.size() == 1) bytes.push_back(std::byte{0});
  bytes[1 + random() % (bytes.size() - 1)] ^= static_cast<std::byte>(1 + random() % 255);
  if (random() % 4 == 0) bytes.resize(random() % bytes.size());
  if (random() % 4 == 0) bytes.insert(bytes.end(), 5, std::byte{1});
  const auto runs = decode(shape, bytes);
  if (runs) {
    RC_ASSERT(validate_runs(*runs, shape.size, shape.axis, shape.voxels).has_value());
  } else {
    RC_ASSERT(runs.error().message == "invalid mask");
  }
}

TEST(MaskCodec, CodesASmoothShapeInAFractionOfItsList) {
  const auto ball = [](auto i, auto j, auto k) {
    const auto x = i - 32, y = j - 32, z = k - 32;
    return x * x + y * y + z * z < 900;
  };
  const Shape shape = shape_of({64, 64, 64}, Axis::kZ, ball);
  std::vector<std::byte> list;
  append_run_list(shape.runs, list);
  EXPECT_LT(encode(shape).size(), list.size() / 6);
}

TEST(MaskCodec, WantsBoxesThatAreFilledAndSlicesThatFitInMemory) {
  const IndexBox cube{{0, 0, 0}, {96, 96, 96}};  // 100 * 100 * 100 / 64 = 15625
  EXPECT_TRUE(codes_mask(cube, 15625));
  EXPECT_FALSE(codes_mask(cube, 15624));
  EXPECT_FALSE(codes_mask({}, 0));
  const std::uint64_t many = std::uint64_t{1} << 40;
  EXPECT_TRUE(codes_mask({{0, 0, 0}, {4092, 4092, 0}}, many));
  EXPECT_FALSE(codes_mask({{0, 0, 0}, {4093, 4092, 0}}, many));
  EXPECT_FALSE(codes_mask({{0, 0, 0}, {4092, 0, 4093}}, many));
  EXPECT_FALSE(codes_mask({{0, 0, 0}, {0, 4092, 4093}}, many));
  EXPECT_TRUE(codes_mask({{0, 0, 0}, {1020, 1020, 252}}, many));  // 2^28
  EXPECT_FALSE(codes_mask({{0, 0, 0}, {1020, 1020, 253}}, many));
}

TEST(MaskCodec, RefusesWhatIsNoMask) {
  const Shape shape = shape_of({9, 9, 9}, Axis::kX, [](auto i, auto j, auto) { return i != j; });
  const std::vector<std::byte> bytes = encode(shape);
  const auto refused = [&](std::span<const std::byte> code, const IndexBox& box, std::uint64_t voxels) {
    return !decode_mask(code, box, shape.size, shape.axis, voxels);
  };
  EXPECT_FALSE(refused(bytes, shape.box, shape.voxels));
  EXPECT_TRUE(refused(bytes, shape.box, shape.voxels + 1));
  EXPECT_TRUE(refused(bytes, shape.box, shape.voxels - 1));
  EXPECT_TRUE(refused(bytes, {}, shape.voxels));
  EXPECT_TRUE(refused({}, shape.box, shape.voxels));
  EXPECT_TRUE(refused(std::span(bytes).subspan(1), shape.box, shape.voxels));
}

}  // namespace
}  // namespace splatlas
