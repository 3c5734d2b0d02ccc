#include "format/derive/label_map.h"

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// True if voxels of the type represent the label exactly.
bool holds_label(VoxelType type, std::int64_t label) {
  return visit_voxel_type(type, [&]<typename T>(T) {
    if constexpr (std::is_integral_v<T>) return std::in_range<T>(label);
    // Exact if at most `digits` bits remain between the highest and the lowest set bit
    const std::uint64_t size =
        label < 0 ? 0 - static_cast<std::uint64_t>(label) : static_cast<std::uint64_t>(label);
    return size == 0 || std::bit_width(size) - std::countr_zero(size) <= std::numeric_limits<T>::digits;
  });
}

/// [class]: its label, or 0.
Result<std::vector<std::int64_t>> labels_of_classes(const AtlasContent& content, const std::string& name,
                                                    std::string_view remedy,
                                                    const std::vector<bool>& wanted) {
  std::vector<std::int64_t> labels(content.classes.size(), 0);
  for (ClassId c = 0; c < labels.size(); ++c) {
    if (content.classes.voxels(c) == 0) continue;
    const Structure* labelled = nullptr;
    for (const Membership& m : content.classes.members(c)) {
      const Structure& structure = content.graph[m.structure];
      if (!m.holds() || !structure.label || (!wanted.empty() && !wanted[m.structure])) continue;
      if (labelled != nullptr) {
        return fail(ErrorCode::kFailed, "{}: '{}' and '{}' overlap; a label map cannot represent this; {}",
                    name, labelled->name, structure.name, remedy);
      }
      if (!holds_label(content.label_type, *structure.label)) {
        return fail(ErrorCode::kFailed, "{}: '{}' has label {}, which {} cannot hold; {}", name,
                    structure.name, *structure.label, name_of(content.label_type), remedy);
      }
      labelled = &structure;
      labels[c] = *structure.label;
    }
  }
  return labels;
}

/// The values [class] in the voxels.
VoxelBuffer voxels_of(const AtlasContent& content, VoxelType type, const std::vector<std::int64_t>& values) {
  VoxelBuffer stored{type, std::vector<std::byte>(content.class_volume.size() * bytes_of(type))};
  visit_voxel_type(type, [&]<typename T>(T) {
    T* voxel = stored.as<T>();
    TaskPace pace;
    for (const ClassId c : content.class_volume) {
      *voxel++ = static_cast<T>(values[c]);
      pace.step();
    }
  });
  return to_source_order(stored, content);
}

}  // namespace

VoxelBuffer to_source_order(const VoxelBuffer& stored, const AtlasContent& content) {
  VoxelBuffer source{stored.type, std::vector<std::byte>(stored.bytes.size())};
  reorder_voxels(stored.bytes.data(), storage_grid(content).size, inverse(content.source_to_storage),
                 bytes_of(stored.type), source.bytes.data());
  return source;
}

VoxelBuffer mask_of(const AtlasContent& content, const std::vector<bool>& wanted) {
  std::vector<std::int64_t> in_class(content.classes.size());
  for (ClassId c = 0; c < in_class.size(); ++c) {
    for (const Membership& m : content.classes.members(c))
      if (m.holds() && wanted[m.structure]) in_class[c] = 1;
  }
  return voxels_of(content, VoxelType::kUInt8, in_class);
}

Result<VoxelBuffer> label_map(const AtlasContent& content, const std::string& name, std::string_view remedy,
                              const std::vector<bool>& wanted) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> labels,
                            labels_of_classes(content, name, remedy, wanted));
  return voxels_of(content, content.label_type, labels);
}

}  // namespace splatlas
