// Encoding of the grey values of a group of classes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/content/run_model.h"
#include "format/derive/value_groups.h"

namespace splatlas {

/// The means of a group, encoded.
struct EncodedMeans {
  std::uint32_t blocks = 0;
  std::vector<std::byte> code;
};

/// Encodes the values of a group into `code`, which must have their length. With `means`, encodes their means
/// as well, if a file may store them. `runs`: of the class volume along z. Linear in the voxels.
[[nodiscard]] EncodedMeans encode_group(const AtlasContent& content, const RunModel& runs,
                                        const ValueGroups& groups, std::size_t group, bool means,
                                        std::span<std::byte> code);

}  // namespace splatlas
