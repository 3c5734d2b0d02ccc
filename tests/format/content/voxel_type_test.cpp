#include "format/content/voxel_type.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

constexpr VoxelType kTypes[]{VoxelType::kUInt8,  VoxelType::kInt8,  VoxelType::kUInt16,  VoxelType::kInt16,
                             VoxelType::kUInt32, VoxelType::kInt32, VoxelType::kFloat32, VoxelType::kFloat64};

TEST(VoxelType, SizeNameAndVisitedTypeAgree) {
  std::set<std::string> names;
  for (const VoxelType type : kTypes) {
    visit_voxel_type(type, [&](auto tag) {
      using T = decltype(tag);
      EXPECT_EQ(bytes_of(type), sizeof(T));
      std::string name = std::is_floating_point_v<T> ? "float" : std::is_signed_v<T> ? "int" : "uint";
      EXPECT_EQ(name_of(type), name + std::to_string(8 * sizeof(T)));
    });
    EXPECT_TRUE(names.insert(name_of(type)).second);
  }
  EXPECT_EQ(bytes_of(VoxelType::kNone), 0u);
  EXPECT_STREQ(name_of(VoxelType::kNone), "none");
}

TEST(VoxelType, NumbersInFilesNeverChange) {
  for (unsigned n = 0; n < std::size(kTypes); ++n) EXPECT_EQ(static_cast<unsigned>(kTypes[n]), n + 1);
  EXPECT_EQ(static_cast<unsigned>(VoxelType::kNone), 0u);
}

TEST(VoxelBuffer, ReadsItsBytesAsVoxels) {
  VoxelBuffer buffer;
  EXPECT_TRUE(buffer.empty());
  buffer = {VoxelType::kInt16, std::vector<std::byte>(4)};
  EXPECT_FALSE(buffer.empty());
  buffer.as<std::int16_t>()[1] = -2;
  const VoxelBuffer copy = buffer;
  EXPECT_EQ(copy, buffer);
  EXPECT_EQ(copy.as<std::int16_t>()[0], 0);
  EXPECT_EQ(copy.as<std::int16_t>()[1], -2);
}

}  // namespace
}  // namespace splatlas
