#include "preprocess/import/labels/import_labels.h"

#include <map>
#include <utility>
#include <vector>

#include "format/result_macros.h"
#include "preprocess/import/images/image_formats.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/labels/label_map.h"
#include "preprocess/import/labels/mask_folder.h"
#include "preprocess/import/labels/segment_layers.h"
#include "preprocess/import/resample.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

Result<ImportedLabels> read_structures(SourceImage image, const std::string& name) {
  return image.is_segmentation ? read_segments(std::move(image), name)
                               : read_label_map(std::move(image), name);
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

Result<ImportedLabels> import_labels(const fs::path& path, const ImageOptions& options,
                                     const std::optional<Grid>& grid) {
  std::error_code unreadable;  // the reader reports it
  const ImageFormatEntry* const format = find_image_format(path);
  if (format == nullptr && fs::is_directory(path, unreadable)) return import_mask_folder(path, grid);
  SPLATLAS_ASSIGN_OR_RETURN(SourceImage image, read_image(path, options));
  const bool is_resampled = grid && !have_same_voxels(*grid, image.grid);
  if (is_resampled && !(overlap(image.grid, *grid) > 0)) {
    return fail(ErrorCode::kFailed, "{}, and they do not overlap; were they made of one patient and frame?",
                check_same_grid(image.grid, path.string(), *grid, "the volume").error().message);
  }
  SourceImage moved = is_resampled ? resample_nearest(image, *grid) : SourceImage();
  SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels labels, read_structures(std::move(image), path.string()));
  if (is_resampled) {
    moved.notes = {};
    SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels resampled, read_structures(std::move(moved), path.string()));
    Notes notes = std::move(labels.notes);
    resampled.notes = std::move(notes);
    resampled.resampled = compare(labels, resampled);
    labels = std::move(resampled);
  }
  labels.files = {path};
  return labels;
}

}  // namespace splatlas
