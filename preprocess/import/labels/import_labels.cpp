#include "preprocess/import/labels/import_labels.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The file's name without its ending, .nii.gz included.
std::string structure_name(const fs::path& file) {
  fs::path name = file.filename();
  if (to_lower(name.extension().string()) == ".gz") name = name.stem();
  return name.stem().string();
}

std::vector<fs::path> list_images(const fs::path& folder) {
  std::vector<fs::path> files = visible_files(folder);
  std::erase_if(files, [](const fs::path& file) {  // ".img" is the second file of a pair
    return to_lower(file.extension().string()) == ".img" || find_image_format(file) == nullptr;
  });
  return files;
}

void take_in_order(const std::vector<StructureIndex>& order, ImportedLabels& labels) {
  std::vector<StructureIndex> new_numbers(labels.structures.size(), 0);
  std::vector<SourceStructure> taken;
  for (const StructureIndex old : order) {
    new_numbers[old] = static_cast<StructureIndex>(taken.size());
    taken.push_back(std::move(labels.structures[old]));
  }
  labels.structures = std::move(taken);
  labels.memberships.renumber(new_numbers);
}

/// Sorts structures by descending number of voxels: the more specific of two that overlap is the later.
void sort_by_size(ImportedLabels& labels, const std::vector<std::uint64_t>& counts) {
  std::vector<StructureIndex> order(counts.size());
  std::iota(order.begin(), order.end(), StructureIndex{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return counts[a] > counts[b]; });
  take_in_order(order, labels);
}

enum class MaskKind { kEmpty, kBinary, kSeveralValues, kProbability, kGrey };

MaskKind kind_of(const VoxelBuffer& voxels) {
  return visit_voxel_type(voxels.type, [&]<typename T>(T) {
    constexpr std::size_t kMostValues = 16;
    std::set<T> values;
    T last = 0, most = 0;
    const std::span all(voxels.as<T>(), voxels.bytes.size() / sizeof(T));
    for (const T value : all) {
      if (value == last || !(value > T(0) || value < T(0))) continue;
      if (value < T(0)) return MaskKind::kGrey;
      most = std::max(most, last = value);
      if (values.size() <= kMostValues) values.insert(value);
    }
    if (values.empty()) return MaskKind::kEmpty;
    if (most <= T(1) && values.size() > 1) return MaskKind::kProbability;
    if (values.size() > kMostValues) return MaskKind::kGrey;
    return values.size() == 1 ? MaskKind::kBinary : MaskKind::kSeveralValues;
  });
}

/// 1 where a probability is 0.5 and above.
VoxelBuffer likely(const VoxelBuffer& voxels) {
  return visit_voxel_type(voxels.type, [&]<typename T>(T) {
    const std::span all(voxels.as<T>(), voxels.bytes.size() / sizeof(T));
    VoxelBuffer mask{VoxelType::kUInt8, std::vector<std::byte>(all.size())};
    std::ranges::transform(all, mask.bytes.begin(),
                           [](T value) { return std::byte(static_cast<double>(value) >= 0.5); });
    return mask;
  });
}

/// The grid that holds all files, if they lie on one lattice; else the one that most of them have. Reads all
/// of them: only for folders where they differ.
Result<Grid> common_grid(const std::vector<fs::path>& files) {
  std::vector<std::pair<Grid, std::size_t>> grids;
  std::optional<Grid> whole;
  for (const fs::path& file : files) {
    SPLATLAS_ASSIGN_OR_RETURN(const Image image, import_image(file));
    const auto known =
        std::ranges::find_if(grids, [&](const auto& one) { return have_same_voxels(one.first, image.grid); });
    if (known != grids.end()) {
      ++known->second;
    } else {
      whole = grids.empty() ? image.grid : whole ? union_of(*whole, image.grid) : std::nullopt;
      grids.emplace_back(image.grid, 1);
    }
  }
  if (whole) return *whole;
  return std::ranges::max_element(grids, {}, [](const auto& one) { return one.second; })->first;
}

class MaskFolder {
 public:
  explicit MaskFolder(std::vector<fs::path> files) { labels_.files = std::move(files); }

  Result<ImportedLabels> import(const std::optional<Grid>& grid) {
    if (grid) begin(*grid, "the volume");
    for (const fs::path& file : labels_.files) {
      SPLATLAS_ASSIGN_OR_RETURN(Image image, import_image(file, {}, labels_.notes));
      SPLATLAS_RETURN_IF_ERROR(add(file, std::move(image)));
    }
    sort_by_size(labels_, counts_);
    return std::move(labels_);
  }

 private:
  void begin(const Grid& grid, const std::string& source) {
    labels_.source_grid = grid;
    labels_.source = source;
    labels_.memberships = MembershipVolume(reordered(grid, storage_order(grid)).size);
    has_grid_ = true;
  }

  Result<void> add(const fs::path& file, Image image) {
    MaskKind kind = kind_of(image.voxels);
    if (kind == MaskKind::kProbability) {
      labels_.notes.add("probability-masks", file.filename().string());
      image.voxels = likely(image.voxels);
      kind = kind_of(image.voxels);
    }
    if (kind == MaskKind::kGrey) {
      labels_.notes.add("grey-masks", file.filename().string());
      return {};
    }
    if (!has_grid_) begin(image.grid, file.string());
    const std::string name = structure_name(file);
    if (kind == MaskKind::kEmpty) {
      labels_.notes.add("empty-masks", name);
      return {};
    }
    if (const auto fit = check_structure_name(name); !fit) return bad_file(file, "{}", fit.error().message);
    if (const auto [other, is_new] = file_of_name_.emplace(name_key(name), file); !is_new)
      return bad_file(file, "names the same structure as {}", other->second.string());
    if (kind == MaskKind::kSeveralValues) labels_.notes.add("masks-with-several-values", name);
    const std::optional<Margin> lacking = margin_around(labels_.source_grid, image.grid);
    const bool is_resampled = !lacking || !lacking->empty();
    ResampledStructure sizes;
    sizes.name = name;
    if (is_resampled) {
      sizes.voxels_before = static_cast<std::uint64_t>(std::ranges::count(mask_of(image.voxels), 1));
      sizes.ml_before = static_cast<double>(sizes.voxels_before) * voxel_volume_mm3(image.grid) / 1000;
    }
    if (!have_same_voxels(labels_.source_grid, image.grid)) {
      image.voxels = resample_nearest(image.voxels, image.grid, labels_.source_grid);
      image.grid = labels_.source_grid;
    }
    const std::uint64_t count =
        labels_.memberships.add(static_cast<StructureIndex>(counts_.size()),
                                mask_of(to_storage_order(std::move(image.voxels), image.grid)));
    if (is_resampled) {
      sizes.voxels_after = count;
      sizes.ml_after = static_cast<double>(count) * voxel_volume_mm3(labels_.source_grid) / 1000;
      labels_.resampled.push_back(std::move(sizes));
    }
    if (count == 0) return {};  // lost by resampling
    counts_.push_back(count);
    labels_.structures.emplace_back().name = name;
    return {};
  }

  ImportedLabels labels_;
  std::vector<std::uint64_t> counts_;
  std::map<std::string, fs::path> file_of_name_;
  bool has_grid_ = false;
};

/// Adds the segments of one layer, and counts their voxels.
template <typename T>
void read_layer(const std::vector<SourceSegment>& segments, std::size_t layer, const VoxelBuffer& voxels,
                ImportedLabels& labels, std::vector<std::uint64_t>& counts) {
  std::map<std::int64_t, StructureIndex> structure_of_value;
  for (StructureIndex n = 0; n < segments.size(); ++n) {
    if (segments[n].layer == layer) structure_of_value.emplace(segments[n].value, n);
  }
  const auto structure_of = [&](T value) {
    if (!(value > 0 || value < 0)) return kNoStructure;
    const auto key = static_cast<std::int64_t>(static_cast<double>(value));  // exact: values have 32 bits
    const auto [found, is_new] = structure_of_value.emplace(key, kNoStructure);
    if (is_new) labels.notes.add("values-without-segment", fmt::format("{} (layer {})", value, layer + 1));
    return found->second;
  };
  std::vector<StructureIndex> structures(voxels.bytes.size() / sizeof(T), kNoStructure);
  T last_value = 0;
  StructureIndex last = kNoStructure;
  for (std::size_t v = 0; v < structures.size(); ++v) {
    if (const T value = voxels.as<T>()[v]; !(value == last_value)) {
      last = structure_of(value);
      last_value = value;
    }
    structures[v] = last;
    if (last != kNoStructure) ++counts[last];
  }
  labels.memberships.combine<StructureIndex>(
      structures, [](std::vector<StructureIndex> set, StructureIndex structure) {
        if (structure != kNoStructure) set.insert(std::ranges::lower_bound(set, structure), structure);
        return set;
      });
}

/// Drops structures without voxels; the others keep their order.
void drop_empty(ImportedLabels& labels, std::vector<std::uint64_t>& counts) {
  std::vector<StructureIndex> kept;
  for (StructureIndex n = 0; n < counts.size(); ++n) {
    if (counts[n] > 0) {
      kept.push_back(n);
    } else {
      labels.notes.add("empty-segments", labels.structures[n].name);
    }
  }
  take_in_order(kept, labels);
  std::erase(counts, 0);
}

/// Every segment of the file is a structure. Cost: a pass a layer.
Result<ImportedLabels> read_segments(SourceImage image, const std::string& name) {
  ImportedLabels result;
  result.source_grid = image.grid;
  result.source = name;
  result.notes = std::move(image.notes);
  const AxisOrder order = storage_order(image.grid);
  result.memberships = MembershipVolume(reordered(image.grid, order).size);
  for (const SourceSegment& segment : image.segments) {
    SourceStructure structure = segment.structure;
    if (const auto fit = check_structure_name(structure.name); !fit) {
      structure.name = fmt::format("Segment {}", result.structures.size() + 1);
      result.notes.add("bad-segment-names", structure.name);
    }
    if (image.layers == 1) structure.label = segment.value;
    result.structures.push_back(std::move(structure));
  }
  std::vector<std::uint64_t> counts(result.structures.size(), 0);
  VoxelBuffer layer{image.voxels.type, {}};
  const std::size_t bytes = static_cast<std::size_t>(image.grid.voxels()) * bytes_of(layer.type);
  for (std::size_t n = 0; n < image.layers; ++n) {
    const auto first = image.voxels.bytes.begin() + static_cast<std::ptrdiff_t>(n * bytes);
    layer.bytes.assign(first, first + static_cast<std::ptrdiff_t>(bytes));
    layer = to_storage_order(std::move(layer), image.grid);
    visit_voxel_type(layer.type,
                     [&]<typename T>(T) { read_layer<T>(image.segments, n, layer, result, counts); });
  }
  drop_empty(result, counts);
  if (result.structures.empty()) {
    std::string text = "holds no segment with voxels";
    for (const Note& note : result.notes.all()) text += "; " + note.message();
    return bad_file(name, "{}", text);
  }
  if (image.layers == 1) {
    result.type = image.voxels.type;
  } else {
    sort_by_size(result, counts);
  }
  return result;
}

Result<ImportedLabels> read_structures(SourceImage image, const std::string& name, bool as_labels) {
  return image.is_segmentation ? read_segments(std::move(image), name)
                               : read_label_map(std::move(image), name, as_labels);
}

/// [structure name and label]: its voxels.
std::map<std::pair<std::string, std::int64_t>, std::uint64_t> count_voxels(const ImportedLabels& labels) {
  std::vector<std::uint64_t> of_set(labels.memberships.sets().size(), 0);
  for (const MembershipVolume::SetId set : labels.memberships.voxels()) ++of_set[set];
  std::map<std::pair<std::string, std::int64_t>, std::uint64_t> counts;
  for (std::size_t set = 0; set < of_set.size(); ++set) {
    for (const StructureIndex s : labels.memberships.sets()[set])
      counts[{labels.structures[s].name, labels.structures[s].label.value_or(0)}] += of_set[set];
  }
  return counts;
}

std::vector<ResampledStructure> compare(const ImportedLabels& before, const ImportedLabels& after) {
  const double ml_before = voxel_volume_mm3(before.source_grid) / 1000,
               ml_after = voxel_volume_mm3(after.source_grid) / 1000;
  auto counts = count_voxels(after);
  std::vector<ResampledStructure> result;
  for (const auto& [structure, voxels] : count_voxels(before)) {
    const std::uint64_t now = counts[structure];
    const std::optional<std::int64_t> label =
        structure.second != 0 ? std::optional(structure.second) : std::nullopt;
    result.push_back({structure.first, label, voxels, now, static_cast<double>(voxels) * ml_before,
                      static_cast<double>(now) * ml_after});
  }
  return result;
}

}  // namespace

Result<ImportedLabels> import_labels(const fs::path& path, ImageOptions options,
                                     const std::optional<Grid>& grid) {
  options.labels = true;
  options.grid = grid;
  std::error_code unreadable;  // the reader reports it
  const ImageFormatEntry* const format = find_image_format(path);
  if (format == nullptr && fs::is_directory(path, unreadable)) return import_mask_folder(path, grid);
  SPLATLAS_ASSIGN_OR_RETURN(SourceImage image, read_image(path, options));
  const bool is_resampled = grid && !have_same_voxels(*grid, image.grid);
  if (is_resampled && !(overlap(image.grid, *grid) > 0)) {
    return fail(ErrorCode::kFailed, "{}, and they do not overlap; were they made of one patient and frame?",
                check_same_grid(image.grid, path.string(), *grid, "the volume").error().message);
  }
  const std::size_t frame_of_reference = image.frame_of_reference;
  SourceImage moved;
  if (is_resampled) {
    moved = image;
    moved.voxels = resample_nearest(image.voxels, image.grid, *grid);
    moved.grid = *grid;
    moved.notes = {};
  }
  SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels labels,
                            read_structures(std::move(image), path.string(), options.as_labels));
  if (is_resampled) {
    SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels resampled,
                              read_structures(std::move(moved), path.string(), options.as_labels));
    resampled.notes = std::move(labels.notes);
    resampled.doubt = labels.doubt;
    resampled.resampled = compare(labels, resampled);
    labels = std::move(resampled);
  }
  labels.files = {path};
  labels.frame_of_reference = frame_of_reference;
  return labels;
}

Result<ImportedLabels> import_mask_folder(const fs::path& folder, const std::optional<Grid>& grid) {
  const std::vector<fs::path> files = list_images(folder);
  if (files.empty()) return bad_file(folder, "holds no mask (.nii.gz, .nrrd, .mha, .mgz, ...)");
  SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels labels, MaskFolder(files).import(grid));
  if (!labels.resampled.empty() && !grid) {
    SPLATLAS_ASSIGN_OR_RETURN(const Grid common, common_grid(files));
    if (!have_same_voxels(labels.source_grid, common)) {
      SPLATLAS_ASSIGN_OR_RETURN(labels, MaskFolder(files).import(common));
    }
  }
  if (labels.structures.empty()) {
    std::string why;
    for (const Note& note : labels.notes.all()) why += note.message() + "; ";
    return bad_file(folder, "holds no mask with voxels; {}a label map is given as a file, not as its folder",
                    why);
  }
  return labels;
}

Result<void> add_labels(ImportedLabels others, ImportedLabels& labels) {
  const std::optional<Grid> whole = union_of(labels.source_grid, others.source_grid);
  const auto around = whole ? margin_around(labels.source_grid, *whole) : std::nullopt;
  const auto around_others = whole ? margin_around(others.source_grid, *whole) : std::nullopt;
  if (!around || !around_others) {
    const auto same = check_same_grid(labels.source_grid, labels.source, others.source_grid, others.source);
    return fail(ErrorCode::kFailed, "--labels: {}; several label maps need voxels of one lattice",
                same ? others.source : same.error().message);
  }
  labels.memberships.widen(*around);
  others.memberships.widen(*around_others);
  labels.source_grid = *whole;
  const auto first = static_cast<StructureIndex>(labels.structures.size());
  labels.memberships.combine(others.memberships.voxels(),
                             [&](std::vector<StructureIndex> set, MembershipVolume::SetId other) {
                               for (const StructureIndex s : others.memberships.sets()[other])
                                 set.push_back(first + s);
                               return set;
                             });
  if (others.type == VoxelType::kNone || labels.type == VoxelType::kNone) {
    labels.type = VoxelType::kNone;
  } else if (bytes_of(others.type) > bytes_of(labels.type)) {
    labels.type = others.type;
  }
  std::ranges::move(others.structures, std::back_inserter(labels.structures));
  std::ranges::move(others.files, std::back_inserter(labels.files));
  std::ranges::move(others.resampled, std::back_inserter(labels.resampled));
  if (labels.doubt.empty()) labels.doubt = others.doubt;
  labels.notes.add(others.notes);
  return {};
}

}  // namespace splatlas
