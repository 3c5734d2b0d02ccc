#include "preprocess/export/export_labels.h"

#include "format/derive/structure_crop.h"
#include "format/system/interrupts.h"
#include "format/system/output_folder.h"
#include "format/system/result_macros.h"
#include "preprocess/export/write_image.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// [class]: its label, or 0.
Result<std::vector<std::int64_t>> labels_of_classes(const AtlasContent& content, const std::string& name) {
  std::vector<std::int64_t> labels(content.classes.size(), 0);
  for (ClassId c = 0; c < labels.size(); ++c) {
    const Structure* labelled = nullptr;
    for (const Membership& m : content.classes.members(c)) {
      const Structure& structure = content.graph[m.structure];
      if (!m.holds() || !structure.label) continue;
      if (labelled != nullptr) {
        return bad_file(
            name, "'{}' and '{}' overlap; a label map cannot represent this; export masks: --labels FOLDER/",
            labelled->name, structure.name);
      }
      labelled = &structure;
      labels[c] = *structure.label;
    }
  }
  return labels;
}

Result<std::size_t> write_masks(const AtlasContent& content, OutputFolder& folder) {
  std::size_t masks = 0;
  const StructureClasses structure_classes(content.classes, content.graph.size());
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    const bool is_group = structure_classes.of(s).empty() && !content.graph.children(s).empty();
    if (content.graph[s].external || is_group) continue;
    const std::vector<std::uint8_t> parts = parts_of(structure_classes.of(s), content.classes.size());
    VoxelBuffer mask{VoxelType::kUInt8, std::vector<std::byte>(content.class_volume.size())};
    for (std::size_t v = 0; v < mask.bytes.size(); ++v)
      mask.bytes[v] = std::byte{parts[content.class_volume[v]] != 0};
    SPLATLAS_RETURN_IF_ERROR(write_image({content.source_grid, to_source_order(mask, content)}, folder,
                                         content.graph[s].id + ".nii.gz"));
    ++masks;
    if (interrupt_waits()) return bad_file(folder.path(), "interrupted");
  }
  return masks;
}

}  // namespace

VoxelBuffer to_source_order(const VoxelBuffer& stored, const AtlasContent& content) {
  VoxelBuffer source{stored.type, std::vector<std::byte>(stored.bytes.size())};
  reorder_voxels(stored.bytes.data(), storage_grid(content).size, inverse(content.source_to_storage),
                 bytes_of(stored.type), source.bytes.data());
  return source;
}

Result<void> export_label_map(const AtlasContent& content, const std::string& name, const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> labels, labels_of_classes(content, name));
  VoxelBuffer stored{content.label_type,
                     std::vector<std::byte>(content.class_volume.size() * bytes_of(content.label_type))};
  visit_voxel_type(stored.type, [&]<typename T>(T) {
    T* const voxels = stored.as<T>();
    for (std::size_t v = 0; v < content.class_volume.size(); ++v) {
      voxels[v] = static_cast<T>(labels[content.class_volume[v]]);
    }
  });
  return write_image({content.source_grid, to_source_order(stored, content)}, path);
}

Result<std::size_t> export_masks(const AtlasContent& content, const fs::path& path) {
  // An interrupt waits for the current mask; then the temporary folder is removed.
  const DeferInterrupts no_folder_left;
  SPLATLAS_ASSIGN_OR_RETURN(OutputFolder folder, OutputFolder::create(path));
  SPLATLAS_ASSIGN_OR_RETURN(const std::size_t masks, write_masks(content, folder));
  SPLATLAS_RETURN_IF_ERROR(folder.commit());
  return masks;
}

}  // namespace splatlas
