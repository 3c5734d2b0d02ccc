// Scalar types of grey values and labels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace splatlas {

/// Numbers are part of the file format and must not change.
enum class VoxelType : std::uint8_t {
  kNone = 0,
  kUInt8 = 1,
  kInt8 = 2,
  kUInt16 = 3,
  kInt16 = 4,
  kUInt32 = 5,
  kInt32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
};

/// Name and bytes of a type; those of kNone for numbers that are none of the above.
struct VoxelTypeEntry {
  const char* name;
  std::size_t bytes;
};
[[nodiscard]] constexpr VoxelTypeEntry entry_of(VoxelType type) {
  constexpr std::array<VoxelTypeEntry, 9> kEntries{{{"none", 0},
                                                    {"uint8", 1},
                                                    {"int8", 1},
                                                    {"uint16", 2},
                                                    {"int16", 2},
                                                    {"uint32", 4},
                                                    {"int32", 4},
                                                    {"float32", 4},
                                                    {"float64", 8}}};
  const auto number = static_cast<std::size_t>(type);
  return kEntries[number < kEntries.size() ? number : 0];
}
[[nodiscard]] constexpr std::size_t bytes_of(VoxelType type) {
  return entry_of(type).bytes;
}
[[nodiscard]] constexpr const char* name_of(VoxelType type) {
  return entry_of(type).name;
}

/// Calls `visit` with a value-initialized object of the C++ type of `type`, as a tag; not for kNone.
template <typename Visitor>
decltype(auto) visit_voxel_type(VoxelType type, Visitor&& visit) {
  switch (type) {
    case VoxelType::kInt8: return visit(std::int8_t{});
    case VoxelType::kUInt16: return visit(std::uint16_t{});
    case VoxelType::kInt16: return visit(std::int16_t{});
    case VoxelType::kUInt32: return visit(std::uint32_t{});
    case VoxelType::kInt32: return visit(std::int32_t{});
    case VoxelType::kFloat32: return visit(float{});
    case VoxelType::kFloat64: return visit(double{});
    case VoxelType::kUInt8:
    case VoxelType::kNone: break;
  }
  return visit(std::uint8_t{});
}

/// Voxels of one type, i fastest. The grid is stored separately.
struct VoxelBuffer {
  VoxelType type = VoxelType::kNone;
  std::vector<std::byte> bytes;

  friend bool operator==(const VoxelBuffer&, const VoxelBuffer&) = default;
  [[nodiscard]] bool empty() const { return type == VoxelType::kNone; }
  template <typename T>
  [[nodiscard]] const T* as() const {
    return reinterpret_cast<const T*>(bytes.data());
  }
  template <typename T>
  [[nodiscard]] T* as() {
    return reinterpret_cast<T*>(bytes.data());
  }
};

}  // namespace splatlas
