#include "preprocess/export/export_labels.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <thread>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "format/derive/structure_crop.h"
#include "format/io/interrupts.h"
#include "format/io/output_folder.h"
#include "format/result_macros.h"
#include "format/tasks/parallel.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"
#include "preprocess/export/file_names.h"
#include "preprocess/export/image_header.h"
#include "preprocess/export/write_image.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

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
Result<std::vector<std::int64_t>> labels_of_classes(const AtlasContent& content, const std::string& name) {
  std::vector<std::int64_t> labels(content.classes.size(), 0);
  for (ClassId c = 0; c < labels.size(); ++c) {
    if (content.classes.voxels(c) == 0) continue;
    const Structure* labelled = nullptr;
    for (const Membership& m : content.classes.members(c)) {
      const Structure& structure = content.graph[m.structure];
      if (!m.holds() || !structure.label) continue;
      if (labelled != nullptr) {
        return bad_file(
            name, "'{}' and '{}' overlap; a label map cannot represent this; export masks: --labels FOLDER/",
            labelled->name, structure.name);
      }
      if (!holds_label(content.label_type, *structure.label)) {
        return bad_file(name, "'{}' has label {}, which {} cannot hold; export masks: --labels FOLDER/",
                        structure.name, *structure.label, name_of(content.label_type));
      }
      labelled = &structure;
      labels[c] = *structure.label;
    }
  }
  return labels;
}

/// Ending of masks: that of NRRD for grids that NIfTI cannot hold.
std::string mask_ending(const Grid& grid) {
  return nifti_header(grid, VoxelType::kUInt8, {}) ? ".nii.gz" : ".nrrd";
}

/// Structures with a mask: no groups, no external surfaces.
std::vector<StructureIndex> masked_structures(const StructureGraph& graph, const StructureClasses& classes) {
  std::vector<StructureIndex> masked;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    const bool is_group = classes.of(s).empty() && !graph.children(s).empty();
    if (!graph[s].external && !is_group) masked.push_back(s);
  }
  return masked;
}

/// Lists ids whose files have other names: at most ten. "" if there are none.
std::string note_changed_names(const std::vector<std::string>& ids, const std::vector<std::string>& files,
                               const std::string& ending, const std::string& folder) {
  constexpr std::size_t kMaxListed = 10;
  std::size_t changed = 0;
  std::string list;
  for (std::size_t n = 0; n < ids.size(); ++n) {
    if (files[n] == ids[n] + ending || ++changed > kMaxListed) continue;
    list += fmt::format("{}{} is {}", list.empty() ? "" : ", ", in_quotes(ids[n]), files[n]);
  }
  if (changed == 0) return {};
  if (changed > kMaxListed) list += fmt::format(" and {} more", changed - kMaxListed);
  return fmt::format("{}: {} {} no safe file {}: {}", folder, changed, changed == 1 ? "id is" : "ids are",
                     changed == 1 ? "name" : "names", list);
}

/// The class volume in the order of the source, and the slices of each class.
class ClassSlices {
 public:
  explicit ClassSlices(const AtlasContent& content)
      : stored_(content.class_volume),
        slice_(static_cast<std::size_t>(content.source_grid.size[0] * content.source_grid.size[1])),
        range_(content.classes.size(), {std::numeric_limits<std::size_t>::max(), 0}) {
    if (!content.source_to_storage.is_identity()) {
      reordered_.resize(stored_.size());
      reorder_voxels(stored_.data(), storage_grid(content).size, inverse(content.source_to_storage),
                     sizeof(ClassId), reordered_.data());
      stored_ = reordered_;
    }
    TaskPace pace;
    for (std::size_t v = 0; v < stored_.size(); ++v) {
      pace.step();
      auto& [first, end] = range_[stored_[v]];
      first = std::min(first, v / slice_);
      end = std::max(end, v / slice_ + 1);
    }
  }

  [[nodiscard]] MaskSlices mask_of(std::span<const StructureClass> members) const {
    std::size_t first = std::numeric_limits<std::size_t>::max(), end = 0;
    for (const StructureClass& member : members) {
      first = std::min(first, range_[member.id].first);
      end = std::max(end, range_[member.id].second);
    }
    if (end == 0) return {};
    const std::vector<std::uint8_t> parts = parts_of(members, range_.size());
    MaskSlices mask{static_cast<std::int64_t>(first), std::vector<std::byte>((end - first) * slice_)};
    for (std::size_t v = 0; v < mask.voxels.size(); ++v)
      mask.voxels[v] = std::byte{parts[stored_[first * slice_ + v]] != 0};
    return mask;
  }

 private:
  std::span<const ClassId> stored_;
  std::vector<ClassId> reordered_;
  std::size_t slice_;
  std::vector<std::pair<std::size_t, std::size_t>> range_;
};

Result<ExportedMasks> write_masks(const AtlasContent& content, OutputFolder& folder) {
  const StructureClasses structure_classes(content.classes, content.graph.size());
  const std::vector<StructureIndex> masked = masked_structures(content.graph, structure_classes);
  std::vector<std::string> ids;
  for (const StructureIndex s : masked) ids.push_back(content.graph[s].id);
  const std::string ending = mask_ending(content.source_grid);
  const std::vector<std::string> files = file_names_of(ids, ending);
  const ClassSlices slices(content);
  const auto encode = [&](std::size_t n) {
    return encode_mask_file(content.source_grid, slices.mask_of(structure_classes.of(masked[n])),
                            folder.path() / files[n]);
  };
  const std::size_t at_once = std::clamp(std::thread::hardware_concurrency(), 1u, 4u);  // bounds the memory
  for (std::size_t first = 0; first < masked.size(); first += at_once) {
    std::vector<Result<std::vector<std::byte>>> encoded(std::min(at_once, masked.size() - first));
    parallel_for(encoded.size(), 0, [&](std::size_t n) { encoded[n] = encode(first + n); });
    for (std::size_t n = 0; n < encoded.size(); ++n) {
      if (!encoded[n]) return tl::unexpected(encoded[n].error());
      SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, folder.create_file(files[first + n]));
      SPLATLAS_RETURN_IF_ERROR(file.write(*encoded[n]));
      SPLATLAS_RETURN_IF_ERROR(folder.add(std::move(file)));
    }
    if (interrupt_waits()) return bad_file(folder.path(), "interrupted");
  }
  ExportedMasks written{masked.size(), {}};
  const std::string path = folder.path().string();
  if (ending == ".nrrd") {
    written.notes.push_back(path + ": .nii.gz files cannot hold the atlas's grid; the masks are .nrrd files");
  }
  if (std::string note = note_changed_names(ids, files, ending, path); !note.empty())
    written.notes.push_back(std::move(note));
  return written;
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

Result<ExportedMasks> export_masks(const AtlasContent& content, const fs::path& path) {
  // An interrupt waits for the current mask; then the temporary folder is removed.
  const DeferInterrupts no_folder_left;
  SPLATLAS_ASSIGN_OR_RETURN(OutputFolder folder, OutputFolder::create(path));
  SPLATLAS_ASSIGN_OR_RETURN(ExportedMasks masks, write_masks(content, folder));
  SPLATLAS_RETURN_IF_ERROR(folder.commit());
  return masks;
}

}  // namespace splatlas
