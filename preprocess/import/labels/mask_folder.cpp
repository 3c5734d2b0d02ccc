#include "preprocess/import/labels/mask_folder.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/image_formats.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/labels/segment_layers.h"
#include "preprocess/import/resample.h"
#include "preprocess/import/tables/structure_name.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

const NoteKind kEmptyMasks{"empty-masks", "mask without voxels is dropped",
                           "masks without voxels are dropped", true};
const NoteKind kGreyFiles{"grey-masks", "file holds grey values, is no mask, and is left out",
                          "files hold grey values, are no masks, and are left out", true};
const NoteKind kWithSeveralValues{"masks-with-several-values",
                                  "mask has several values; all but 0 are inside",
                                  "masks have several values; all but 0 are inside", true};
/// The file's name without its ending, .nii.gz included.
std::string structure_name(const fs::path& file) {
  fs::path name = file.filename();
  if (to_lower(name.extension().string()) == ".gz") name = name.stem();
  return name.stem().string();
}

std::vector<fs::path> list_images(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string ending = to_lower(entry->path().extension().string());
    const bool is_second_of_pair = ending == ".img";
    if (entry->is_regular_file() && find_image_format(entry->path()) != nullptr && !is_second_of_pair)
      files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

enum class MaskKind { kEmpty, kBinary, kSeveralValues, kGrey };

MaskKind kind_of(const VoxelBuffer& voxels) {
  return visit_voxel_type(voxels.type, [&]<typename T>(T) {
    constexpr std::size_t kMostValues = 16;
    std::set<T> values;
    T last = 0;
    const std::span all(voxels.as<T>(), voxels.bytes.size() / sizeof(T));
    for (const T value : all) {
      if (value == last || !(value > T(0) || value < T(0))) continue;
      if (value < T(0)) return MaskKind::kGrey;
      values.insert(last = value);
      if (values.size() > kMostValues) return MaskKind::kGrey;
    }
    return values.empty()       ? MaskKind::kEmpty
           : values.size() == 1 ? MaskKind::kBinary
                                : MaskKind::kSeveralValues;
  });
}

std::uint64_t count_voxels(const VoxelBuffer& voxels) {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(mask_of(voxels), [](std::uint8_t in) { return in != 0; }));
}

/// The grid that most files have. Reads all of them: only for folders where they differ.
Result<Grid> most_frequent_grid(const std::vector<fs::path>& files) {
  std::vector<std::pair<Grid, std::size_t>> grids;
  for (const fs::path& file : files) {
    SPLATLAS_ASSIGN_OR_RETURN(const Image image, import_image(file));
    const auto known =
        std::ranges::find_if(grids, [&](const auto& one) { return have_same_voxels(one.first, image.grid); });
    if (known != grids.end()) {
      ++known->second;
    } else {
      grids.emplace_back(image.grid, 1);
    }
  }
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
    const MaskKind kind = kind_of(image.voxels);
    if (kind == MaskKind::kGrey) return note(kGreyFiles, file);
    if (!has_grid_) begin(image.grid, file.string());
    const std::string name = structure_name(file);
    if (kind == MaskKind::kEmpty) {
      labels_.notes.add(kEmptyMasks, name);
      return {};
    }
    if (const auto fit = check_structure_name(name); !fit) return bad_file(file, "{}", fit.error().message);
    if (const auto [other, is_new] = file_of_name_.emplace(name_key(name), file); !is_new)
      return bad_file(file, "names the same structure as {}", other->second.string());
    if (kind == MaskKind::kSeveralValues) labels_.notes.add(kWithSeveralValues, name);
    const bool is_resampled = !have_same_voxels(labels_.source_grid, image.grid);
    ResampledStructure sizes;
    sizes.name = name;
    if (is_resampled) {
      sizes.voxels_before = count_voxels(image.voxels);
      sizes.ml_before = static_cast<double>(sizes.voxels_before) * voxel_volume_mm3(image.grid) / 1000;
      image.voxels = resample_nearest(image, labels_.source_grid);
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
    SourceStructure structure;
    structure.name = name;
    labels_.structures.push_back(std::move(structure));
    return {};
  }

  Result<void> note(const NoteKind& kind, const fs::path& file) {
    labels_.notes.add(kind, file.filename().string());
    return {};
  }

  ImportedLabels labels_;
  std::vector<std::uint64_t> counts_;
  std::map<std::string, fs::path> file_of_name_;
  bool has_grid_ = false;
};

}  // namespace

bool is_mask_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) && !list_images(path).empty();
}

Result<ImportedLabels> import_mask_folder(const fs::path& folder, const std::optional<Grid>& grid) {
  const std::vector<fs::path> files = list_images(folder);
  if (files.empty()) return bad_file(folder, "holds no mask (.nii.gz, .nrrd, .mha, .mgz, ...)");
  SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels labels, MaskFolder(files).import(grid));
  if (!labels.resampled.empty() && !grid) {
    SPLATLAS_ASSIGN_OR_RETURN(const Grid frequent, most_frequent_grid(files));
    if (!have_same_voxels(labels.source_grid, frequent)) {
      SPLATLAS_ASSIGN_OR_RETURN(labels, MaskFolder(files).import(frequent));
    }
  }
  if (labels.structures.empty()) return bad_file(folder, "holds no mask with voxels");
  return labels;
}

}  // namespace splatlas
