// Integers of 64 bits, as the 32 bits of an atlas.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "format/content/voxel_type.h"
#include "format/result.h"

namespace splatlas {

enum class WideInteger : std::uint8_t { kNone, kSigned, kUnsigned };

/// int32 if all values fit, else uint32. kFailed, with the value, if one fits neither. `bytes` are of this
/// machine's byte order.
[[nodiscard]] Result<VoxelBuffer> narrow_integers(std::span<const std::byte> bytes, WideInteger type,
                                                  const std::filesystem::path& path);

}  // namespace splatlas
