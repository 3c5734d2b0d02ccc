#include "preprocess/import/images/import_labels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/images/check_image_file.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/structure_name.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

using SetId = MembershipVolume::SetId;

/// The label of a voxel value; nothing for an invalid one.
template <typename T>
std::optional<std::uint32_t> label_of(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (!(value >= 0 && value < T(4294967296.0) && std::floor(value) == value)) return std::nullopt;
  } else {
    if (value < 0) return std::nullopt;
  }
  return static_cast<std::uint32_t>(value);
}

/// Labels in the order of their first voxel (set n + 1 is label n), and the set of every voxel.
struct FoundLabels {
  std::vector<std::uint32_t> labels;
  std::vector<SetId> voxels;
};

template <typename T>
Result<FoundLabels> find_labels(const VoxelBuffer& image, const std::string& name) {
  FoundLabels found;
  const std::size_t count = image.bytes.size() / sizeof(T);
  found.voxels.resize(count);
  std::unordered_map<std::uint32_t, SetId> set_of_label{{0, 0}};
  T last_value = 0;
  SetId last_set = 0;
  for (std::size_t v = 0; v < count; ++v) {
    if (const T value = image.as<T>()[v]; !(value == last_value)) {
      const auto label = label_of(value);
      if (!label) {
        return bad_file(name, "holds the value {}, which is no label (0 to 4294967295, whole)", value);
      }
      const auto [entry, is_new] = set_of_label.emplace(*label, static_cast<SetId>(set_of_label.size()));
      if (is_new) found.labels.push_back(*label);
      last_set = entry->second;
      last_value = value;
    }
    found.voxels[v] = last_set;
  }
  return found;
}

Index3 storage_size(const Grid& source) {
  return reordered(source, storage_order(source)).size;
}

/// The file's name without its ending, .nii.gz included.
std::string structure_name(const fs::path& file) {
  fs::path name = file.filename();
  if (to_lower(name.extension().string()) == ".gz") name = name.stem();
  return name.stem().string();
}

Result<std::vector<fs::path>> list_masks(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (image_format(entry->path())) files.push_back(entry->path());
  }
  if (error) return bad_file(folder, "{}", error.message());
  if (files.empty()) return bad_file(folder, "holds no mask (.nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd)");
  std::sort(files.begin(), files.end());
  return files;
}

/// Sorts structures by descending voxel count; stable.
void sort_by_size(ImportedLabels& masks, const std::vector<std::uint64_t>& counts) {
  std::vector<StructureIndex> order(counts.size());
  std::iota(order.begin(), order.end(), StructureIndex{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return counts[a] > counts[b]; });
  std::vector<StructureIndex> new_numbers(order.size());
  std::vector<SourceStructure> sorted;
  for (StructureIndex n = 0; n < order.size(); ++n) {
    new_numbers[order[n]] = n;
    sorted.push_back(masks.structures[order[n]]);
  }
  masks.structures = std::move(sorted);
  masks.memberships.renumber(new_numbers);
}

}  // namespace

Result<ImportedLabels> import_label_map(const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(Image image, import_image(path));
  Result<ImportedLabels> labels = read_label_map(std::move(image), path.string());
  if (labels) labels->files = {path};
  return labels;
}

Result<ImportedLabels> read_label_map(Image image, const std::string& name) {
  const VoxelBuffer stored = to_storage_order(std::move(image.voxels), image.grid);
  Result<FoundLabels> found =
      visit_voxel_type(stored.type, [&]<typename T>(T) { return find_labels<T>(stored, name); });
  if (!found) return tl::unexpected(found.error());

  ImportedLabels result;
  result.source_grid = image.grid;
  result.source = name;
  result.type = stored.type;
  std::vector<std::uint32_t> sorted = found->labels;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::vector<StructureIndex>> sets{{}};
  for (const std::uint32_t label : found->labels) {
    const auto rank = std::lower_bound(sorted.begin(), sorted.end(), label) - sorted.begin();
    sets.push_back({static_cast<StructureIndex>(rank)});
  }
  for (const std::uint32_t label : sorted) {
    SourceStructure structure;
    structure.name = fmt::format("Label {}", label);
    structure.label = label;
    result.structures.push_back(std::move(structure));
  }
  if (sorted.empty()) result.notes.push_back(fmt::format("{}: holds background only", name));
  result.memberships = MembershipVolume(storage_size(image.grid), std::move(sets), std::move(found->voxels));
  return result;
}

Result<ImportedLabels> import_mask_folder(const fs::path& folder) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<fs::path> files, list_masks(folder));
  ImportedLabels result;
  result.files = files;
  std::vector<std::uint64_t> counts;
  std::map<std::string, fs::path> file_of_name;
  for (const fs::path& file : files) {
    SPLATLAS_ASSIGN_OR_RETURN(Image image, import_image(file));
    if (counts.empty()) {
      result.source_grid = image.grid;
      result.source = file.string();
      result.memberships = MembershipVolume(storage_size(image.grid));
    }
    SPLATLAS_RETURN_IF_ERROR(check_same_grid(result.source_grid, result.source, image.grid, file.string()));
    SourceStructure structure;
    structure.name = structure_name(file);
    if (const auto fit = check_structure_name(structure.name); !fit) {
      return bad_file(file, "{}", fit.error().message);
    }
    if (const auto [other, is_new] = file_of_name.emplace(name_key(structure.name), file); !is_new) {
      return bad_file(file, "names the same structure as {}", other->second.string());
    }
    if (holds_several_values(image.voxels)) {
      result.notes.push_back(fmt::format(
          "{}: has more values than one besides 0; all of them are inside the structure", file.string()));
    }
    counts.push_back(
        result.memberships.add(static_cast<StructureIndex>(counts.size()),
                               mask_of(to_storage_order(std::move(image.voxels), result.source_grid))));
    if (counts.back() == 0) {
      result.notes.push_back(fmt::format("{}: holds no voxel; kept as an empty structure", file.string()));
    }
    result.structures.push_back(std::move(structure));
  }
  sort_by_size(result, counts);
  return result;
}

Result<void> name_labels(ImportedLabels& labels, const std::vector<LabelName>& names, const std::string& file,
                         bool allow_empty) {
  std::map<std::int64_t, SourceStructure*> unnamed;
  for (SourceStructure& structure : labels.structures) unnamed.emplace(*structure.label, &structure);
  std::vector<SourceStructure> empty;
  for (const LabelName& name : names) {
    if (!name.label) continue;  // a table of names alone
    const auto found = unnamed.find(*name.label);
    if (found == unnamed.end() && !allow_empty) {
      return bad_file(file,
                      "line {}: no voxel of {} has label {} ('{}'); --allow-empty keeps such structures",
                      name.line, labels.source, *name.label, name.name);
    }
    SourceStructure& structure = found == unnamed.end() ? empty.emplace_back() : *found->second;
    structure = name;
    if (found != unnamed.end()) unnamed.erase(found);
  }
  if (!unnamed.empty()) {
    std::string list;
    std::size_t listed = 0;
    for (const auto& [label, structure] : unnamed) {
      if (listed++ == 20) {
        list += ", ...";
        break;
      }
      list += fmt::format("{}{}", list.empty() ? "" : ", ", label);
    }
    return bad_file(file, "names no structure for {} of the labels of {}: {}", unnamed.size(), labels.source,
                    list);
  }
  std::sort(empty.begin(), empty.end(), [](const auto& a, const auto& b) { return *a.label < *b.label; });
  labels.structures.insert(labels.structures.end(), empty.begin(), empty.end());
  return {};
}

}  // namespace splatlas
