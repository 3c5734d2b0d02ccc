#include "preprocess/export/export_labels.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "format/derive/label_map.h"
#include "format/derive/structure_crop.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/tasks/thread_pool.h"
#include "format/text/ascii_text.h"
#include "preprocess/export/write_image.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

// A mask builds back if its name is one of a structure. Linux allows 255 bytes, NTFS and APFS 255 characters.
constexpr std::size_t kMaxBytes = kMaxNameCharacters;
static_assert(kMaxBytes + std::string_view(".nii.gz").size() <= 255);

/// The name with safe characters only, of at most kMaxBytes. Safe names are unchanged.
std::string safe_name(std::string_view name) {
  std::string safe;
  bool in_run = false;
  for (const char c : name) {
    const bool is_safe = is_ascii_letter_or_digit(c) || c == '_' || c == '-' || c == '.';
    if (is_safe || !in_run) safe += is_safe ? c : '_';
    in_run = !is_safe;
  }
  if (safe.empty() || safe.front() == '-' || safe.front() == '.') safe.insert(0, 1, '_');
  safe.resize(std::min(safe.size(), kMaxBytes));
  if (safe.back() == '.') safe.back() = '_';
  return safe;
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

/// `classes`: the class of each voxel.
VoxelBuffer mask_of(std::span<const StructureClass> members, std::size_t count, const VoxelBuffer& classes) {
  const std::vector<std::uint8_t> parts = parts_of(members, count);
  VoxelBuffer mask{VoxelType::kUInt8, std::vector<std::byte>(classes.bytes.size() / sizeof(ClassId))};
  std::transform(classes.as<ClassId>(), classes.as<ClassId>() + mask.bytes.size(), mask.bytes.begin(),
                 [&](ClassId c) { return std::byte{parts[c] != 0}; });
  return mask;
}

Result<ExportedMasks> write_masks(const AtlasContent& content, const fs::path& path, OutputFolder& folder) {
  const StructureClasses structure_classes(content.classes, content.graph.size());
  const std::vector<StructureIndex> masked = masked_structures(content.graph, structure_classes);
  std::vector<std::string> ids;
  for (const StructureIndex s : masked) ids.push_back(content.graph[s].id);
  const bool fits_nifti = nifti_header(content.source_grid, VoxelType::kUInt8, {}).has_value();
  const std::string ending = fits_nifti ? ".nii.gz" : ".nrrd";
  const std::vector<std::string> files = file_names_of(ids, ending);
  const auto stored = std::as_bytes(std::span(content.class_volume));
  const VoxelBuffer classes = to_source_order({VoxelType::kUInt32, {stored.begin(), stored.end()}}, content);
  const auto encode = [&](std::size_t n) {
    return encode_image(
        {content.source_grid, mask_of(structure_classes.of(masked[n]), content.classes.size(), classes)},
        path / files[n]);
  };
  const std::size_t at_once = std::clamp(std::thread::hardware_concurrency(), 1u, 4u);  // bounds the memory
  for (std::size_t first = 0; first < masked.size(); first += at_once) {
    std::vector<Result<std::vector<std::byte>>> encoded(std::min(at_once, masked.size() - first));
    parallel_for(encoded.size(), 0, [&](std::size_t n) { encoded[n] = encode(first + n); });
    for (std::size_t n = 0; n < encoded.size(); ++n) {
      if (!encoded[n]) return tl::unexpected(encoded[n].error());
      SPLATLAS_RETURN_IF_ERROR(
          folder.add(files[first + n], [&](OutputFile& file) { return file.write(*encoded[n]); }));
    }
  }
  ExportedMasks written{masked.size(), {}};
  if (ending == ".nrrd")
    written.notes.push_back(fmt::format(
        "{}: .nii.gz files cannot hold the atlas's grid; the masks are .nrrd files", path.string()));
  std::size_t changed = 0;
  for (std::size_t n = 0; n < ids.size(); ++n) changed += files[n] == ids[n] + ending ? 0 : 1;
  if (changed > 0)
    written.notes.push_back(fmt::format(
        "{}: {} of the ids are no safe file names; their files have \"_\" in them", path.string(), changed));
  return written;
}

}  // namespace

std::vector<std::string> structures_without_label(const AtlasContent& content) {
  std::vector<bool> holds(content.graph.size());
  for (ClassId c = 0; c < content.classes.size(); ++c) {
    if (content.classes.voxels(c) == 0) continue;
    for (const Membership& m : content.classes.members(c))
      holds[m.structure] = holds[m.structure] || m.holds();
  }
  std::vector<std::string> names;
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    if (holds[s] && !content.graph[s].label) names.push_back(content.graph[s].name);
  }
  return names;
}

Result<ExportedMasks> export_masks(const AtlasContent& content, const fs::path& path,
                                   std::span<OutputFile> others) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFolder folder, OutputFolder::create(path));
  SPLATLAS_ASSIGN_OR_RETURN(ExportedMasks masks, write_masks(content, path, folder));
  SPLATLAS_RETURN_IF_ERROR(commit_files(others));
  SPLATLAS_RETURN_IF_ERROR(folder.commit());
  return masks;
}

std::vector<std::string> file_names_of(std::span<const std::string> names, std::string_view ending) {
  std::vector<std::string> result;
  std::set<std::string> taken;  // lower case

  // Keep safe names, the first of those that differ only by case
  std::vector<bool> is_kept;
  for (const std::string& name : names) {
    result.push_back(safe_name(name));
    is_kept.push_back(result.back() == name && taken.insert(to_lower(name)).second);
  }

  // Number the others where their name is taken
  std::map<std::string, int> last_number;  // by lower case
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (is_kept[n] || taken.insert(to_lower(result[n])).second) continue;
    const std::string base = result[n];
    int& number = last_number.try_emplace(to_lower(base), 1).first->second;
    do {
      const std::string suffix = fmt::format("_{}", ++number);
      result[n] = base.substr(0, kMaxBytes - suffix.size()) + suffix;
    } while (!taken.insert(to_lower(result[n])).second);
  }
  for (std::string& name : result) name += ending;
  return result;
}

}  // namespace splatlas
