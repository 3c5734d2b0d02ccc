#include "preprocess/import_sources.h"

#include <map>

#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/file_hash.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/images/import_labels.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/read_names.h"
#include "preprocess/import/tables/structure_name.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Imports the files into a SourceModel, kind by kind.
class SourceImporter {
 public:
  SourceImporter(const SourceFiles& files, const std::function<void(double)>& progress)
      : files_(files), progress_(progress) {}

  Result<SourceModel> import() {
    SPLATLAS_RETURN_IF_ERROR(collect_names());
    SPLATLAS_RETURN_IF_ERROR(import_tree());
    SPLATLAS_RETURN_IF_ERROR(import_labels());
    SPLATLAS_RETURN_IF_ERROR(check_names_of_labels());
    report(0.4);
    SPLATLAS_RETURN_IF_ERROR(import_volume());
    report(0.7);
    SPLATLAS_RETURN_IF_ERROR(import_segment_masks());
    report(0.9);
    SPLATLAS_RETURN_IF_ERROR(import_meshes());
    for (const Note& note : notes_.all()) {
      if (note.kind.is_warning) model_.notes.push_back(note.message());
    }
    return std::move(model_);
  }

 private:
  void report(double fraction) const {
    if (progress_) progress_(fraction);
  }

  Result<void> remember(const std::string& role, const fs::path& file) {
    SPLATLAS_ASSIGN_OR_RETURN(std::string hash, hash_file(file));
    model_.provenance.push_back({role, std::move(hash)});
    return {};
  }

  /// The first volume determines the grid; all others must match it.
  Result<void> join_grid(const Grid& grid, const std::string& file) {
    if (grid_file_.empty()) {
      model_.source_grid = grid;
      grid_file_ = file;
      return {};
    }
    return check_same_grid(model_.source_grid, grid_file_, grid, file);
  }

  /// Checks that the names of segments and meshes are unique.
  Result<void> collect_names() {
    for (const SegmentRule& rule : files_.segments)
      SPLATLAS_RETURN_IF_ERROR(collect_name("--segment", rule.name));
    for (const SourceFiles::Mesh& mesh : files_.meshes)
      SPLATLAS_RETURN_IF_ERROR(collect_name("--mesh", mesh.name));
    return {};
  }

  Result<void> collect_name(const std::string& option, const std::string& name) {
    if (const auto fit = check_structure_name(name); !fit) {
      return fail(ErrorCode::kUsage, "{}: {}", option, fit.error().message);
    }
    const auto [other, is_new] = option_of_name_.emplace(name_key(name), option);
    if (is_new) return {};
    return fail(ErrorCode::kUsage, "{}: the name {} is taken by a {} already; names differ by more than case",
                option, in_quotes(name), other->second);
  }

  Result<void> check_names_of_labels() {
    for (const SourceStructure& structure : model_.structures) {
      const auto option = option_of_name_.find(name_key(structure.name));
      if (option == option_of_name_.end()) continue;
      return fail(ErrorCode::kUsage, "{}: the name {} is taken by a structure of {} already", option->second,
                  in_quotes(structure.name), files_.labels.string());
    }
    return {};
  }

  Result<void> import_tree() {
    if (files_.tree.empty()) return {};
    model_.tree_file = files_.tree.string();
    SPLATLAS_ASSIGN_OR_RETURN(model_.tree, read_tree(files_.tree, notes_));
    return remember("tree", files_.tree);
  }

  Result<void> import_labels() {
    if (files_.labels.empty()) return {};
    std::error_code unreadable;  // the importer reports it
    const bool masks = fs::is_directory(files_.labels, unreadable);
    SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels labels,
                              masks ? import_mask_folder(files_.labels) : import_label_map(files_.labels));
    if (!files_.names.empty()) {
      if (masks) return fail(ErrorCode::kUsage, "--names: is for label maps; masks are named by their files");
      SPLATLAS_ASSIGN_OR_RETURN(const NamesTable table, read_names(files_.names, NamesFormat::kAuto, notes_));
      SPLATLAS_RETURN_IF_ERROR(name_labels(labels, table.names, files_.names.string(), files_.allow_empty));
      SPLATLAS_RETURN_IF_ERROR(remember("names", files_.names));
    }
    if (!files_.colors.empty()) {
      SPLATLAS_ASSIGN_OR_RETURN(const auto colors, read_color_table(files_.colors));
      for (SourceStructure& structure : labels.structures) {
        if (structure.label && *structure.label < 256)
          structure.color = colors[static_cast<std::size_t>(*structure.label)];
      }
      SPLATLAS_RETURN_IF_ERROR(remember("colors", files_.colors));
    }
    SPLATLAS_RETURN_IF_ERROR(join_grid(labels.source_grid, labels.source));
    for (const fs::path& file : labels.files) SPLATLAS_RETURN_IF_ERROR(remember("labels", file));
    model_.label_type = labels.type;
    model_.memberships = std::move(labels.memberships);
    model_.structures = std::move(labels.structures);
    model_.notes = std::move(labels.notes);
    return {};
  }

  Result<void> import_volume() {
    if (files_.volume.empty()) return {};
    SPLATLAS_ASSIGN_OR_RETURN(Image image, import_image(files_.volume));
    SPLATLAS_RETURN_IF_ERROR(join_grid(image.grid, files_.volume.string()));
    model_.values = to_storage_order(std::move(image.voxels), model_.source_grid);
    return remember("volume", files_.volume);
  }

  Result<void> import_segment_masks() {
    for (const SegmentRule& rule : files_.segments) {
      SourceModel::Segment segment{rule, {}};
      if (rule.kind == SegmentRule::Kind::kMask) {
        SPLATLAS_ASSIGN_OR_RETURN(Image image, import_image(rule.mask));
        SPLATLAS_RETURN_IF_ERROR(join_grid(image.grid, rule.mask.string()));
        segment.mask = mask_of(to_storage_order(std::move(image.voxels), model_.source_grid));
        SPLATLAS_RETURN_IF_ERROR(remember("segment", rule.mask));
      } else if (model_.values.empty()) {
        return fail(ErrorCode::kUsage, "--segment \"{}\": {} needs a --volume", rule.name,
                    rule.kind == SegmentRule::Kind::kIsosurface ? "an isosurface" : "a threshold");
      }
      SourceStructure structure;
      structure.name = rule.name;
      model_.structures.push_back(std::move(structure));
      model_.segments.push_back(std::move(segment));
    }
    // Without labels, start with empty memberships on the grid of the volume or the first mask.
    if (files_.labels.empty()) model_.memberships = MembershipVolume(storage_grid().size);
    return {};
  }

  Result<void> import_meshes() {
    for (const SourceFiles::Mesh& source : files_.meshes) {
      const std::string file = source.file.string();
      SPLATLAS_ASSIGN_OR_RETURN(const TriangleMesh mesh, import_mesh(source.file, files_.mesh_frame));
      Result<ClippedMesh> clipped = clip_mesh(mesh, storage_grid());
      if (!clipped) return fail(clipped.error().code, "{}: {}", file, clipped.error().message);
      if (clipped->crossed.empty()) return bad_file(file, "is outside the volume; check --mesh-frame");
      if (mesh.dropped > 0) {
        model_.notes.push_back(fmt::format("{}: {} degenerate triangles are dropped", file, mesh.dropped));
      }
      constexpr double kNegligible = 1e-6;
      if (clipped->outside > kNegligible) {
        model_.notes.push_back(fmt::format("{}: {:.1f} % of the surface is outside the volume and dropped",
                                           file, 100 * clipped->outside));
      }
      SourceStructure structure;
      structure.name = source.name;
      structure.external = true;
      model_.structures.push_back(std::move(structure));
      model_.meshes.push_back(std::move(*clipped));
      SPLATLAS_RETURN_IF_ERROR(remember("mesh", source.file));
    }
    return {};
  }

  [[nodiscard]] Grid storage_grid() const {
    return reordered(model_.source_grid, storage_order(model_.source_grid));
  }

  const SourceFiles& files_;
  const std::function<void(double)>& progress_;
  SourceModel model_;
  Notes notes_;
  std::string grid_file_;
  std::map<std::string, std::string> option_of_name_;  // by name_key
};

}  // namespace

Result<SourceModel> import_sources(const SourceFiles& files, const std::function<void(double)>& progress) {
  if (files.labels.empty() && files.segments.empty()) {
    return fail(ErrorCode::kUsage, "no structures: give --labels or a --segment");
  }
  if (files.labels.empty() && (!files.names.empty() || !files.colors.empty())) {
    return fail(ErrorCode::kUsage, "--names and --colors need --labels");
  }
  return SourceImporter(files, progress).import();
}

std::vector<fs::path> list_files(const SourceFiles& files) {
  std::vector<fs::path> list;
  for (const fs::path& path : {files.labels, files.volume, files.names, files.colors, files.tree}) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
      for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
        list.push_back(entry->path());
      }
    } else if (!path.empty()) {
      list.push_back(path);
    }
  }
  for (const SegmentRule& rule : files.segments) {
    if (!rule.mask.empty()) list.push_back(rule.mask);
  }
  for (const auto& mesh : files.meshes) list.push_back(mesh.file);
  return list;
}

}  // namespace splatlas
