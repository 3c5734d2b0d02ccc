#include "preprocess/export/export_atlas.h"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/derive/label_map.h"
#include "format/io/output_file.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "preprocess/export/export_labels.h"
#include "preprocess/export/export_tables.h"
#include "preprocess/export/write_image.h"
#include "preprocess/export/write_mesh.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The structures of each requested surface.
Result<std::vector<std::vector<StructureIndex>>> find_surfaces(const Atlas& atlas,
                                                               const ExportOptions& options) {
  std::vector<std::vector<StructureIndex>> result;
  for (const auto& [name, path] : options.surfaces) {
    const auto found = atlas.graph().find(name);
    if (!found) return fail(found.error().code, "{}: {}", atlas.name(), found.error().message);
    std::vector<StructureIndex> all = atlas.graph().descendants(*found);
    if (std::ranges::all_of(all, [&](StructureIndex s) { return atlas.triangles(s) == 0; }))
      return bad_file(atlas.name(), "'{}' has no surface", name);
    std::ranges::sort(all);
    result.push_back(std::move(all));
  }
  return result;
}

bool is_folder_of_masks(const ExportOptions& options) {
  return options.labels.ends_with('/');
}

std::vector<fs::path> outputs_of(const ExportOptions& options) {
  std::vector<fs::path> outputs{options.streams_labels()      ? fs::path()
                                : is_folder_of_masks(options) ? fs::path(options.labels).parent_path()
                                                              : fs::path(options.labels),
                                options.volume, options.names, options.tree};
  for (const auto& [name, path] : options.surfaces) outputs.push_back(path);
  std::erase(outputs, fs::path());
  return outputs;
}

/// Checks file types, and conflicts between outputs and inputs: kUsage.
Result<void> check_words(const ExportOptions& options, std::span<const fs::path> outputs) {
  if (!options.labels.empty() && !options.streams_labels() && !is_folder_of_masks(options))
    SPLATLAS_RETURN_IF_ERROR(writable_image_format(options.labels));
  if (!options.volume.empty()) SPLATLAS_RETURN_IF_ERROR(writable_image_format(options.volume));
  for (const auto& [name, path] : options.surfaces) SPLATLAS_RETURN_IF_ERROR(writable_mesh_format(path));
  if (outputs.empty() && !options.streams_labels()) {
    return fail(ErrorCode::kUsage,
                "{}: nothing to export: give --labels, --volume, --surface, --names or --tree",
                options.atlas.string());
  }
  if (is_folder_of_masks(options)) {
    const fs::path folder = resolve_output(outputs.front());
    for (const fs::path& path : outputs.subspan(1)) {
      if (resolve_output(path.parent_path()) != folder) continue;
      return fail(ErrorCode::kUsage, "{}: lies in the folder of masks, {}; export to another one",
                  path.string(), options.labels);
    }
  }
  return check_outputs(outputs, std::array{options.atlas});
}

Result<void> check_writable(const ExportOptions& options, std::span<const fs::path> outputs) {
  if (is_folder_of_masks(options)) {
    SPLATLAS_RETURN_IF_ERROR(check_writable_folder(options.labels));
    outputs = outputs.subspan(1);
  }
  for (const fs::path& path : outputs) SPLATLAS_RETURN_IF_ERROR(check_writable_file(path));
  return {};
}

/// Checks the memory of writing volumes of `bytes` bytes a value: class volume, and `copies` copies.
void check_volumes(const Grid& grid, std::size_t copies, std::size_t bytes) {
  check_memory(static_cast<double>(grid.voxels()) * static_cast<double>(sizeof(ClassId) + copies * bytes));
}

/// Files that are written, to be named together.
using UnnamedFiles = std::vector<OutputFile>;

/// Exports labels as a label map, or as masks, together with the files before. Adds notes.
Result<std::string> export_labels(const AtlasContent& content, const Atlas& atlas,
                                  const ExportOptions& options, UnnamedFiles& unnamed, ExportedFiles& files) {
  if (is_folder_of_masks(options)) {
    check_volumes(atlas.grid(), 2, sizeof(ClassId));  // in the order of the source; masks
    SPLATLAS_ASSIGN_OR_RETURN(const ExportedMasks masks, export_masks(content, options.labels, unnamed));
    unnamed.clear();
    files.notes.insert(files.notes.end(), masks.notes.begin(), masks.notes.end());
    return fmt::format("{}: {} masks", options.labels, masks.count);
  }
  check_volumes(atlas.grid(), 2, bytes_of(content.label_type));
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer labels,
                            label_map(content, atlas.name(), "export masks: --labels FOLDER/"));
  if (options.streams_labels()) {
    SPLATLAS_ASSIGN_OR_RETURN(files.stream, encode_image({content.source_grid, labels}, "labels.nrrd"));
  } else {
    SPLATLAS_ASSIGN_OR_RETURN(unnamed.emplace_back(),
                              write_image({content.source_grid, labels}, options.labels));
  }
  if (const auto left_out = structures_without_label(content); !left_out.empty()) {
    constexpr std::size_t kMaxListed = 10;
    const auto listed = std::span(left_out).first(std::min(left_out.size(), kMaxListed));
    files.notes.push_back(fmt::format(
        "{}: leaves out structures without a label: {}{}; --labels FOLDER/ writes masks",
        options.streams_labels() ? "standard output" : options.labels, fmt::join(listed, ", "),
        left_out.size() > kMaxListed ? fmt::format(" and {} more", left_out.size() - kMaxListed) : ""));
  }
  return fmt::format("{}: labels, {}", options.labels, name_of(content.label_type));
}

Result<std::string> export_volume(const AtlasContent& content, const Atlas& atlas, const fs::path& path,
                                  UnnamedFiles& unnamed) {
  check_volumes(atlas.grid(), 4, bytes_of(atlas.value_type()));
  SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer values, atlas.read_value_volume(content.class_volume));
  SPLATLAS_ASSIGN_OR_RETURN(unnamed.emplace_back(),
                            write_image({content.source_grid, to_source_order(values, content)}, path));
  return fmt::format("{}: volume, {}", path.string(), name_of(values.type));
}

Result<std::string> export_surface(const Atlas& atlas, const std::vector<StructureIndex>& structures,
                                   const fs::path& path, UnnamedFiles& unnamed) {
  constexpr double kBytesPerTriangle = 280;
  double written = 0;
  for (const StructureIndex s : structures) written += static_cast<double>(atlas.triangles(s));
  check_memory(written * kBytesPerTriangle);
  std::vector<SurfaceMesh> surfaces;
  std::uint64_t triangles = 0;
  for (const StructureIndex s : structures) {
    SPLATLAS_ASSIGN_OR_RETURN(surfaces.emplace_back(), atlas.read_surface(s));
    triangles += surfaces.back().triangles.size();
  }
  SPLATLAS_ASSIGN_OR_RETURN(unnamed.emplace_back(), write_mesh(surfaces, atlas.grid(), path));
  return fmt::format("{}: {} triangles", path.string(), triangles);
}

/// Records the result of one output. Returns true if the export continues: on success and after damage.
bool note(Result<std::string> result, const std::string& output, ExportedFiles& files) {
  if (result) {
    files.written.push_back(*std::move(result));
    return true;
  }
  Error error = std::move(result).error();
  const bool is_damage = error.code == ErrorCode::kInvalidAtlas;
  if (is_damage) files.damaged.push_back(output);
  files.failures.push_back(std::move(error));
  return is_damage;
}

/// Writes the outputs in order, up to a failure that is no damage; masks last. True if there is none.
bool write_outputs(const Atlas& atlas, const std::vector<std::vector<StructureIndex>>& structures,
                   const ExportOptions& options, UnnamedFiles& unnamed, ExportedFiles& files) {
  const auto table = [&](const Result<std::string>& text, const char* kind, const fs::path& path) {
    Result<std::string> line = fmt::format("{}: {}", path.string(), kind);
    const Result<void> added = text ? add_file(path, std::as_bytes(std::span(*text)), unnamed)
                                    : fail(text.error().code, "{}: {}", path.string(), text.error().message);
    if (!added) line = tl::unexpected(added.error());
    return note(std::move(line), path.string(), files);
  };
  if (!options.names.empty() &&
      !table(names_text(atlas.graph(), options.names_format), "names", options.names))
    return false;
  if (const std::string lost = losses_of(atlas.graph(), options.names_format);
      !options.names.empty() && !lost.empty())
    files.notes.push_back(
        fmt::format("{}: does not hold {}; --names-format csv does", options.names.string(), lost));
  if (!options.tree.empty() && !table(tree_text(atlas.graph()), "tree", options.tree)) return false;
  const auto voxels = [&](bool has_labels, bool has_volume) {
    if (!has_labels && !has_volume) return true;
    const Result<AtlasContent> content = atlas.read_classes();
    const auto write = [&](const std::string& path, const auto& body) {
      return note(content ? body() : Result<std::string>(tl::unexpected(content.error())), path, files);
    };
    return (!has_labels ||
            write(options.labels, [&] { return export_labels(*content, atlas, options, unnamed, files); })) &&
           (!has_volume || write(options.volume.string(),
                                 [&] { return export_volume(*content, atlas, options.volume, unnamed); }));
  };
  const bool has_masks = is_folder_of_masks(options);
  if (!voxels(!options.labels.empty() && !has_masks, !options.volume.empty())) return false;
  for (std::size_t n = 0; n < structures.size(); ++n) {
    const fs::path& path = options.surfaces[n].second;
    if (!note(export_surface(atlas, structures[n], path, unnamed), path.string(), files)) return false;
  }
  return voxels(has_masks, false);
}

}  // namespace

Result<ExportedFiles> export_atlas(const ExportOptions& options) {
  const std::vector<fs::path> outputs = outputs_of(options);
  SPLATLAS_RETURN_IF_ERROR(check_words(options, outputs));
  SPLATLAS_RETURN_IF_ERROR(check_writable(options, outputs));
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas,
                            Atlas::open(options.atlas, options.atlas_options));
  SPLATLAS_ASSIGN_OR_RETURN(const auto structures, find_surfaces(*atlas, options));
  if (!options.volume.empty() && atlas->value_type() == VoxelType::kNone)
    return bad_file(atlas->name(), "holds no grey values to export");
  if (!options.labels.empty() && !is_folder_of_masks(options) && atlas->label_type() == VoxelType::kNone)
    return bad_file(atlas->name(), "was not made from a label map; export masks: --labels FOLDER/");
  ExportedFiles files;
  try {
    const TaskControl task({}, {}, &atlas->work_budget());
    UnnamedFiles unnamed;
    if (write_outputs(*atlas, structures, options, unnamed, files)) {
      const Result<void> named = commit_files(unnamed);
      if (named) return files;
      files.failures.push_back(named.error());
    }
  } catch (const OverBudget& over) {
    files.failures.push_back(over.error());
  }
  files.written.clear();
  files.stream.clear();
  return files;
}

}  // namespace splatlas
