#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/labels/import_labels.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

using SetId = MembershipVolume::SetId;

std::string default_name(std::int64_t label) {
  return fmt::format("Label {}", label);
}

/// True for a label that no file has named.
bool has_default_name(const SourceStructure& structure) {
  return structure.label && structure.name == default_name(*structure.label);
}

std::string shown(const SourceStructure& structure) {
  return structure.label ? fmt::format("{} ({})", structure.name, *structure.label) : structure.name;
}

/// The nearest label to a voxel value, 0 for NaN and infinity; nothing for an invalid one.
template <typename T>
std::optional<std::uint32_t> label_of(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(value)) return 0;
    value = std::round(value);
    if (!(value >= 0 && value < T(4294967296.0))) return std::nullopt;
  } else {
    if (value < 0) return std::nullopt;
  }
  return static_cast<std::uint32_t>(value);
}

/// Labels in the order of their first voxel (set n + 1 is label n), and the set of every voxel.
struct FoundLabels {
  std::vector<std::uint32_t> labels;
  std::vector<SetId> voxels;
  double most_rounded = 0;
  std::size_t nans = 0;
};

template <typename T>
Result<FoundLabels> find_labels(const VoxelBuffer& image, const std::string& name, double tolerance) {
  FoundLabels found;
  const std::size_t count = image.bytes.size() / sizeof(T);
  found.voxels.resize(count);
  std::unordered_map<std::uint32_t, SetId> set_of_label{{0, 0}};
  T last_value = 0;
  SetId last_set = 0;
  for (std::size_t v = 0; v < count; ++v) {
    if (const T value = image.as<T>()[v]; !(value == last_value)) {
      const auto label = label_of(value);
      const auto number = static_cast<double>(value), nearest = static_cast<double>(label.value_or(0));
      const double rounded = std::isfinite(number) ? std::abs(number - nearest) : 0;
      if (!label || rounded > tolerance) {
        return bad_file(
            name,
            "holds the value {}, which is no label (0 to 4294967295, whole); grey values belong to "
            "--volume; {}",
            value, label ? "--as-labels rounds them" : "labels cannot be negative or larger");
      }
      found.most_rounded = std::max(found.most_rounded, rounded);
      const auto [entry, is_new] = set_of_label.emplace(*label, static_cast<SetId>(set_of_label.size()));
      if (is_new) found.labels.push_back(*label);
      last_set = entry->second;
      last_value = value;
    }
    if constexpr (std::is_floating_point_v<T>) found.nans += std::isfinite(image.as<T>()[v]) ? 0 : 1;
    found.voxels[v] = last_set;
  }
  return found;
}

void note_rounding(const FoundLabels& found, VoxelType type, const std::string& name, Notes& notes) {
  if (found.most_rounded > 0)
    notes.add("rounded-labels", fmt::format("{} (by at most {:.2g})", name, found.most_rounded));
  if (found.nans > 0) notes.add("nan-voxels", fmt::format("{} ({})", name, found.nans));
  constexpr std::uint32_t kMostExact = 1u << 24;
  const bool is_large = !found.labels.empty() && std::ranges::max(found.labels) > kMostExact;
  if (type == VoxelType::kFloat32 && is_large) notes.add("inexact-labels", name);
}

/// Grey values: neighbours along a row mostly differ, or values have few voxels each. Neither holds for label
/// maps, even with voxels of 8 mm.
std::string doubt_about(const FoundLabels& found, const Index3& size, const std::string& name) {
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
  return fmt::format(
      "{}: looks like grey values, not labels: {} values in {} voxels, and {:.0f} % of neighbours are equal; "
      "give it as "
      "--volume, and make structures of it by --segment; names for all labels or --as-labels overrule this",
      name, found.labels.size(), inside, 100 * fraction);
}

/// Names of the file itself.
void name_by_segments(const std::vector<SourceSegment>& segments, ImportedLabels& labels) {
  std::map<std::int64_t, const SourceStructure*> by_value;
  for (const SourceSegment& segment : segments) by_value.emplace(segment.value, &segment.structure);
  for (SourceStructure& structure : labels.structures) {
    const auto found = by_value.find(*structure.label);
    if (found == by_value.end()) continue;
    if (const auto fit = check_structure_name(found->second->name); !fit) {
      labels.notes.add("bad-names", structure.name);
      continue;
    }
    const auto label = structure.label;
    structure = *found->second;
    structure.label = label;
  }
}

void drop_labels(NamesTable& table, const std::set<std::int64_t>& labels) {
  std::erase_if(table.names,
                [&](const LabelName& name) { return name.label && labels.contains(*name.label); });
}

/// Drops the names of groups of the table's hierarchy: they have no voxels of their own.
void drop_groups(NamesTable& table, std::span<const SourceStructure> structures) {
  std::set<std::string> parents;
  for (const TreeLine& line : table.hierarchy) {
    if (line.node) parents.insert(line.node->parents.begin(), line.node->parents.end());
  }
  std::set<std::int64_t> groups;
  for (const TreeLine& line : table.hierarchy) {
    if (line.node && line.node->label && parents.contains(line.node->key)) groups.insert(*line.node->label);
  }
  for (const SourceStructure& structure : structures) groups.erase(structure.label.value_or(0));
  drop_labels(table, groups);
}

/// Drops the names of labels that resampling lost: a note has told them.
void drop_lost(NamesTable& table, std::span<const ResampledStructure> resampled) {
  std::set<std::int64_t> lost;
  for (const ResampledStructure& sizes : resampled) {
    if (sizes.voxels_after == 0) lost.insert(sizes.label.value_or(0));
  }
  drop_labels(table, lost);
}

std::string remedy_for(const ImportedLabels& labels, const NamesTable& table) {
  if (!labels.structures.front().label)
    return "masks and overlapping segments have no labels: give the rows their names";
  if (table.columns.empty()) return "give the table of these labels, or another --names-format";
  return fmt::format("no column of labels was found in {}; call it \"label\"",
                     fmt::join(table.columns, ", "));
}

/// True for names that tables give to label 0.
bool is_background(std::string_view name) {
  constexpr std::string_view kWords =
      "background unknown clear none outside exterior undefined unlabel unclass void empty zero air null bg "
      "root ?";
  return std::ranges::any_of(split_blanks(kWords), [lower = to_lower(name)](std::string_view word) {
    return lower.find(word) != std::string::npos;
  });
}

void note_shared(ImportedLabels& labels) {
  std::map<std::string, int> names, colors;
  for (const SourceStructure& structure : labels.structures) {
    if (++names[structure.group + '/' + name_key(structure.name)] == 2)
      labels.notes.add("duplicate-names", in_quotes(structure.name));
    if (structure.color && ++colors[structure.group + to_hex(*structure.color)] == 2)
      labels.notes.add("duplicate-colors", to_hex(*structure.color));
  }
}

}  // namespace

Result<void> check_doubt(const ImportedLabels& labels) {
  const bool is_named = std::ranges::none_of(labels.structures, has_default_name);
  return labels.doubt.empty() || is_named ? Result<void>() : fail(ErrorCode::kFailed, "{}", labels.doubt);
}

Result<ImportedLabels> read_label_map(SourceImage image, const std::string& name, bool as_labels) {
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
  const double tolerance = as_labels ? 0.5 : 1e-3;
  Result<FoundLabels> found =
      visit_voxel_type(stored.type, [&]<typename T>(T) { return find_labels<T>(stored, name, tolerance); });
  if (!found) return tl::unexpected(found.error());
  note_rounding(*found, stored.type, name, result.notes);
  if (!as_labels) result.doubt = doubt_about(*found, size, name);
  constexpr std::size_t kMaxDoubted = 65536;
  if (!result.doubt.empty() && found->labels.size() > kMaxDoubted)
    return fail(ErrorCode::kFailed, "{}", result.doubt);

  std::vector<std::uint32_t> sorted = found->labels;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::vector<StructureIndex>> sets{{}};
  for (const std::uint32_t label : found->labels) {
    const auto rank = std::lower_bound(sorted.begin(), sorted.end(), label) - sorted.begin();
    sets.push_back({static_cast<StructureIndex>(rank)});
  }
  for (const std::uint32_t label : sorted)
    result.structures.push_back({.name = default_name(label), .label = label});
  name_by_segments(image.segments, result);
  if (sorted.empty()) result.notes.add("no-labels", name);
  result.memberships = MembershipVolume(size, std::move(sets), std::move(found->voxels));
  return result;
}

Result<void> name_labels(ImportedLabels& labels, NamesTable table, bool keeps_empty) {
  drop_groups(table, labels.structures);
  drop_lost(table, labels.resampled);
  std::vector<LabelName>& names = table.names;
  std::multimap<std::int64_t, SourceStructure*> unnamed;
  std::multimap<std::string, SourceStructure*> by_name;  // masks, and labels that the file itself names
  for (SourceStructure& structure : labels.structures) {
    if (structure.label) unnamed.emplace(*structure.label, &structure);
    if (!has_default_name(structure)) by_name.emplace(name_key(structure.name), &structure);
  }
  std::vector<SourceStructure> empty;
  std::vector<std::string> unused;
  const auto rename = [](const auto& range, const SourceStructure& name) {
    for (auto found = range.first; found != range.second; ++found) {
      SourceStructure& structure = *found->second;
      const auto [label, group] = std::pair(structure.label, structure.group);
      structure = name;
      structure.label = label;
      structure.group = group;
    }
    return range.first != range.second;
  };
  for (LabelName& name : names) {
    const auto keyed = [&](const std::string& key) { return by_name.equal_range(name_key(key)); };
    if (name.label && rename(unnamed.equal_range(*name.label), name)) {
      unnamed.erase(*name.label);
    } else if (rename(keyed(name.name), name) || (!name.key.empty() && rename(keyed(name.key), name))) {
      continue;
    } else if (keeps_empty && name.label) {
      empty.push_back(std::move(name));
    } else {
      unused.push_back(shown(name));
    }
  }
  if (!names.empty() && unused.size() == names.size() && !labels.structures.empty())
    return fail(ErrorCode::kFailed, "the first is {}, and the first structure is {}; {}", unused.front(),
                shown(labels.structures.front()), remedy_for(labels, table));
  for (std::string& name : unused) labels.notes.add("names-without-voxels", std::move(name));
  bool lacks_names = false;
  for (const auto& [label, structure] : unnamed) {
    if (!has_default_name(*structure)) continue;
    labels.notes.add("unnamed-labels", fmt::to_string(label));
    lacks_names = true;
  }
  if (lacks_names && !table.zero_name.empty() && !is_background(table.zero_name))
    labels.notes.add("counts-from-0",
                     fmt::format("row 0 is {}, but 0 is background", in_quotes(table.zero_name)));
  note_shared(labels);
  std::ranges::stable_sort(empty, {}, [](const SourceStructure& structure) { return *structure.label; });
  labels.structures.insert(labels.structures.end(), empty.begin(), empty.end());
  return {};
}

void note_resampled(const ImportedLabels& labels, std::span<const LabelName> names, Notes& notes) {
  std::map<std::int64_t, std::string> name_of_label;
  for (const LabelName& name : names) {
    if (name.label) name_of_label.emplace(*name.label, name.name);
  }
  std::vector<ResampledStructure> resampled = labels.resampled;
  std::ranges::stable_sort(resampled, std::greater{}, [](const ResampledStructure& sizes) {
    return std::abs(sizes.ml_after - sizes.ml_before) / sizes.ml_before;
  });
  for (const ResampledStructure& sizes : resampled) {
    const auto named = name_of_label.find(sizes.label.value_or(0));
    const std::string& name = named != name_of_label.end() ? named->second : sizes.name;
    if (sizes.voxels_after == 0) {
      notes.add("lost-structures",
                fmt::format("{} ({} voxels, {:.4g} ml)", name, sizes.voxels_before, sizes.ml_before));
    } else if (sizes.voxels_before != sizes.voxels_after || sizes.ml_before < sizes.ml_after ||
               sizes.ml_before > sizes.ml_after) {
      notes.add("resampled-structures",
                fmt::format("{} ({} voxels, {:.4g} ml, become {} voxels, {:.4g} ml)", name,
                            sizes.voxels_before, sizes.ml_before, sizes.voxels_after, sizes.ml_after));
    }
  }
}

}  // namespace splatlas
