#include "preprocess/import/labels/label_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

using SetId = MembershipVolume::SetId;

const NoteKind kNoLabel{"no-labels", "label map holds background only", "label maps hold background only",
                        true};
const NoteKind kUnnamed{"unnamed-labels", "label has no name and is called \"Label N\"",
                        "labels have no names and are called \"Label N\"", true};
/// A table that names mostly other structures serves many images: then unused names are no fault.
NoteKind unused_names(bool is_warning) {
  return {"names-without-voxels", "name has no voxel and is dropped", "names have no voxels and are dropped",
          is_warning};
}
const NoteKind kBadHeaderName{
    "bad-names", "name in an image file cannot be used; its label is called \"Label N\"",
    "names in an image file cannot be used; their labels are called \"Label N\"", true};

std::string default_name(std::int64_t label) {
  return fmt::format("Label {}", label);
}

std::string shown(const SourceStructure& structure) {
  return structure.label ? fmt::format("{} ({})", structure.name, *structure.label) : structure.name;
}

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
        return bad_file(
            name,
            "holds the value {}, which is no label (0 to 4294967295, whole); grey values belong to --volume",
            value);
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

/// Grey values: neighbours along a row mostly differ, or values have few voxels each. Neither holds for label
/// maps, even with voxels of 8 mm.
Result<void> check_no_grey(const FoundLabels& found, const Index3& size, const std::string& name) {
  constexpr std::size_t kMinValues = 64;
  constexpr double kMaxEqual = 0.4;
  constexpr std::uint64_t kMinVoxelsEach = 8;  // of a label, in the mean
  if (found.labels.size() < kMinValues) return {};
  std::uint64_t pairs = 0, equal = 0, inside = found.voxels[0] != 0 ? 1 : 0;
  const auto row = static_cast<std::size_t>(size[0]);
  for (std::size_t v = 1; v < found.voxels.size(); ++v) {
    inside += found.voxels[v] != 0 ? 1 : 0;
    if (v % row == 0 || found.voxels[v] == 0 || found.voxels[v - 1] == 0) continue;
    ++pairs;
    equal += found.voxels[v] == found.voxels[v - 1] ? 1 : 0;
  }
  const double fraction = pairs > 0 ? static_cast<double>(equal) / static_cast<double>(pairs) : 1;
  if (fraction >= kMaxEqual && inside >= kMinVoxelsEach * found.labels.size()) return {};
  return bad_file(
      name,
      "looks like grey values, not labels: {} values in {} voxels, and {:.0f} % of neighbours are equal; "
      "give it as --volume, and make structures of it by --segment",
      found.labels.size(), inside, 100 * fraction);
}

/// Names of the file itself.
void name_by_segments(const std::vector<SourceSegment>& segments, ImportedLabels& labels) {
  std::map<std::int64_t, const SourceStructure*> by_value;
  for (const SourceSegment& segment : segments) by_value.emplace(segment.value, &segment.structure);
  for (SourceStructure& structure : labels.structures) {
    const auto found = by_value.find(*structure.label);
    if (found == by_value.end()) continue;
    if (const auto fit = check_structure_name(found->second->name); !fit) {
      labels.notes.add(kBadHeaderName, structure.name);
      continue;
    }
    const auto label = structure.label;
    structure = *found->second;
    structure.label = label;
  }
}

}  // namespace

Result<ImportedLabels> read_label_map(SourceImage image, const std::string& name) {
  if (image.layers > 1) {
    return bad_file(
        name, "holds {} volumes, and names no segments in them; give one label map, or a folder of masks",
        image.layers);
  }
  const VoxelBuffer stored = to_storage_order(std::move(image.voxels), image.grid);
  ImportedLabels result;
  result.source_grid = image.grid;
  result.source = name;
  result.type = stored.type;
  result.notes = std::move(image.notes);
  const Index3 size = reordered(image.grid, storage_order(image.grid)).size;
  Result<FoundLabels> found =
      visit_voxel_type(stored.type, [&]<typename T>(T) { return find_labels<T>(stored, name); });
  if (!found) return tl::unexpected(found.error());
  SPLATLAS_RETURN_IF_ERROR(check_no_grey(*found, size, name));

  std::vector<std::uint32_t> sorted = found->labels;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::vector<StructureIndex>> sets{{}};
  for (const std::uint32_t label : found->labels) {
    const auto rank = std::lower_bound(sorted.begin(), sorted.end(), label) - sorted.begin();
    sets.push_back({static_cast<StructureIndex>(rank)});
  }
  for (const std::uint32_t label : sorted) {
    SourceStructure structure;
    structure.name = default_name(label);
    structure.label = label;
    result.structures.push_back(std::move(structure));
  }
  name_by_segments(image.segments, result);
  if (sorted.empty()) result.notes.add(kNoLabel, name);
  result.memberships = MembershipVolume(size, std::move(sets), std::move(found->voxels));
  return result;
}

Result<void> name_labels(ImportedLabels& labels, std::vector<LabelName> names, bool keeps_empty) {
  std::map<std::int64_t, SourceStructure*> unnamed;
  std::map<std::string, SourceStructure*> by_name;  // masks, and labels that the file itself names
  for (SourceStructure& structure : labels.structures) {
    const bool is_named = !structure.label || structure.name != default_name(*structure.label);
    if (structure.label) unnamed.emplace(*structure.label, &structure);
    if (is_named) by_name.emplace(name_key(structure.name), &structure);
  }
  std::vector<SourceStructure> empty;
  std::vector<std::string> unused;
  for (LabelName& name : names) {
    const auto found = name.label ? unnamed.find(*name.label) : unnamed.end();
    auto same_name = by_name.find(name_key(name.name));
    if (same_name == by_name.end() && !name.key.empty()) same_name = by_name.find(name_key(name.key));
    if (found != unnamed.end()) {
      *found->second = std::move(name);
      unnamed.erase(found);
    } else if (same_name != by_name.end()) {
      name.label = same_name->second->label;
      *same_name->second = std::move(name);
    } else if (keeps_empty && name.label) {
      empty.push_back(std::move(name));
    } else {
      unused.push_back(shown(name));
    }
  }
  if (!names.empty() && unused.size() == names.size() && !labels.structures.empty())
    return fail(ErrorCode::kFailed, "line {} is {}, and the first structure is {}; {}", names.front().line,
                unused.front(), shown(labels.structures.front()),
                labels.structures.front().label
                    ? "give the table of these labels, or another --names-format"
                    : "masks and overlapping segments have no labels: give the rows their names");
  const NoteKind kind = unused_names(2 * unused.size() <= names.size());
  for (std::string& name : unused) labels.notes.add(kind, std::move(name));
  for (const auto& [label, structure] : unnamed) {
    if (structure->name == default_name(label)) labels.notes.add(kUnnamed, fmt::to_string(label));
  }
  std::ranges::stable_sort(empty, {}, [](const SourceStructure& structure) { return *structure.label; });
  labels.structures.insert(labels.structures.end(), empty.begin(), empty.end());
  return {};
}

}  // namespace splatlas
