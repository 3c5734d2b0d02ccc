#include "preprocess/sources/import_sources.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/images/pixels/image_readers.h"
#include "preprocess/import/labels/import_labels.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Imports the files into a SourceModel, kind by kind.
class SourceImporter {
 public:
  SourceImporter(const SourceFiles& files, Notes& notes, const std::function<void(double)>& progress)
      : files_(files), notes_(notes), progress_(progress) {}

  Result<SourceModel> import() {
    keep_error(collect_names());
    keep_error(import_tree());
    // Labels first, unless they need the grid of the volume: reading them takes the most memory.
    bool to_volume = files_.resample == ResampleTo::kVolume || is_contours(files_.labels);
    for (const LabelsFile& more : files_.more_labels) to_volume = to_volume || is_contours(more.file);
    if (to_volume) keep_error(import_volume());
    keep_error(import_names());
    keep_error(import_labels());
    if (!error_) keep_error(split_labels());
    keep_error(check_names_of_labels());
    report(0.4);
    if (!to_volume) keep_error(import_volume());
    report(0.7);
    if (!error_) keep_error(place_volume());
    keep_error(import_segment_masks());
    report(0.9);
    if (!error_) keep_error(import_meshes());
    if (error_) return tl::unexpected(*error_);
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

  /// Keeps the first error; notes further ones.
  void keep_error(Result<void> result) {
    if (result) return;
    if (error_) {
      notes_.add("further-errors", result.error().message);
    } else {
      error_ = std::move(result).error();
    }
  }

  /// Checks that the names of segments, meshes and groups of labels are unique.
  Result<void> collect_names() {
    if (!files_.labels_group.empty()) SPLATLAS_RETURN_IF_ERROR(collect_name("--labels", files_.labels_group));
    for (const LabelsFile& more : files_.more_labels)
      SPLATLAS_RETURN_IF_ERROR(collect_name("--labels", more.group));
    for (const SegmentRule& rule : files_.segments)
      SPLATLAS_RETURN_IF_ERROR(collect_name("--segment", rule.name));
    for (const MeshSource& mesh : files_.meshes) SPLATLAS_RETURN_IF_ERROR(collect_name("--mesh", mesh.name));
    return {};
  }

  Result<void> collect_name(const std::string& option, const std::string& name) {
    if (const auto fit = check_structure_name(name); !fit)
      return fail(ErrorCode::kUsage, "{}: {}", option, fit.error().message);
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
    std::error_code other;
    Notes same;  // of a file that is read as names, too, and told then
    const bool is_same = fs::equivalent(files_.tree, files_.names, other);
    SPLATLAS_ASSIGN_OR_RETURN(model_.tree, read_tree(files_.tree, is_same ? same : notes_));
    return remember("tree", files_.tree);
  }

  Result<void> import_volume() {
    if (files_.volume.empty()) return {};
    ImageOptions options = files_.volume_options;
    options.spacing_mm = files_.spacing_mm;
    SPLATLAS_ASSIGN_OR_RETURN(volume_, import_image(files_.volume, options, notes_));
    return {};
  }

  Result<void> import_names() {
    if (files_.names.empty()) return {};
    SPLATLAS_ASSIGN_OR_RETURN(names_, read_names(files_.names, files_.names_format, notes_));
    return remember("names", files_.names);
  }

  [[nodiscard]] Result<ImportedLabels> import_labels_of(const LabelsFile& source,
                                                        const std::optional<Grid>& grid) const {
    Result<ImportedLabels> labels = splatlas::import_labels(
        source.file, {.spacing_mm = files_.spacing_mm, .as_labels = files_.as_labels}, grid);
    if (!labels) return labels;
    for (SourceStructure& structure : labels->structures) structure.group = source.group;
    return labels;
  }

  Result<void> import_labels() {
    if (files_.labels.empty()) return {};
    const std::optional<Grid> grid = volume_ ? std::optional(volume_->grid) : std::nullopt;
    SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels labels,
                              import_labels_of({files_.labels_group, files_.labels}, grid));
    for (const LabelsFile& more : files_.more_labels) {
      SPLATLAS_ASSIGN_OR_RETURN(ImportedLabels others, import_labels_of(more, grid));
      SPLATLAS_RETURN_IF_ERROR(add_labels(std::move(others), labels));
    }
    note_resampled(labels, names_ ? names_->names : std::vector<LabelName>(), notes_);
    SPLATLAS_RETURN_IF_ERROR(apply_names(labels, files_.labels.string()));
    SPLATLAS_RETURN_IF_ERROR(check_doubt(labels));
    for (const fs::path& file : labels.files) SPLATLAS_RETURN_IF_ERROR(remember("labels", file));
    notes_.add(labels.notes);
    model_.source_grid = labels.source_grid;
    model_.label_type = labels.type;
    model_.memberships = std::move(labels.memberships);
    model_.structures = std::move(labels.structures);
    labels_source_ = labels.source;
    labels_frame_ = labels.frame_of_reference;
    return {};
  }

  Result<void> split_labels() {
    if (files_.sides.empty()) return {};
    const std::string text = files_.sides.string();
    std::error_code unreadable;
    if (text.starts_with("x=") && !fs::exists(files_.sides, unreadable)) {
      const auto x_mm = parse_number(text.substr(2));
      if (!x_mm || !(std::abs(*x_mm) <= kMaxMm))
        return fail(ErrorCode::kUsage, "--sides {}: must be x=MM or an image of 1 (left) and 2 (right)",
                    in_quotes(text));
      split_sides(model_, sides_of_plane(model_.storage_grid(), *x_mm), text, notes_);
      return {};
    }
    SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer image, import_on_grid(files_.sides, "sides", text));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::uint8_t> sides, sides_of_image(image, files_.sides));
    split_sides(model_, sides, text, notes_);
    return {};
  }

  /// Gives structures their names of the table; its hierarchy is the tree if there is no other.
  Result<void> apply_names(ImportedLabels& labels, const std::string& source) {
    if (!names_) return {};
    std::vector<TreeLine> hierarchy = names_->hierarchy;
    const NamesFormat dialect = names_->dialect;
    if (const auto fit = name_labels(labels, *std::exchange(names_, std::nullopt),
                                     files_.allow_empty && !files_.labels.empty());
        !fit) {
      return bad_file(files_.names, "is read as {}, and no row fits {}: {}",
                      std::ranges::find(names_formats(), dialect, &NamesFormatInfo::format)->title, source,
                      fit.error().message);
    }
    if (files_.tree.empty() && !hierarchy.empty()) {
      model_.tree = std::move(hierarchy);
      model_.tree_file = files_.names.string();
    }
    return {};
  }

  /// Brings labels and volume onto one grid: that of the volume if the labels have a part of its voxels, else
  /// that of the labels.
  Result<void> place_volume() {
    if (!volume_) return {};
    if (files_.labels.empty()) model_.source_grid = volume_->grid;
    const std::optional<Margin> margin =
        files_.resample == ResampleTo::kAsk ? margin_around(model_.source_grid, volume_->grid) : std::nullopt;
    const Margin added = margin.value_or(Margin{});
    const Grid whole =
        widened(model_.source_grid, before_reordering(added, storage_order(model_.source_grid)));
    if (!added.empty() && have_same_voxels(whole, volume_->grid)) {
      model_.memberships.widen(added);
      model_.source_grid = whole;
      notes_.add("labels-widened", files_.labels.string());
    }
    const std::size_t frame = volume_->frame_of_reference;
    if (frame != 0 && labels_frame_ != 0 && frame != labels_frame_)
      notes_.add("other-frame-of-reference",
                 "labels and volume differ in FrameOfReferenceUID, and need not fit");
    if (!have_same_voxels(model_.source_grid, volume_->grid)) {
      const std::string difference =
          check_same_grid(model_.source_grid, labels_source_, volume_->grid, files_.volume.string())
              .error()
              .message;
      if (!(overlap(model_.source_grid, volume_->grid) > 0))
        return fail(ErrorCode::kFailed,
                    "{}, and they do not overlap; were they made of one patient and frame?", difference);
      notes_.add("resampled-volume", fmt::format("{} ({}; --resample volume keeps its grid instead)",
                                                 files_.volume.string(), difference));
      volume_->voxels = resample_linear(*volume_, model_.source_grid);
      volume_->grid = model_.source_grid;
    }
    model_.values = to_storage_order(std::move(volume_->voxels), volume_->grid);
    return remember("volume", files_.volume);
  }

  Result<void> import_segment_masks() {
    for (const SegmentRule& rule : files_.segments) {
      SourceModel::Segment segment{rule, {}};
      if (rule.kind == SegmentRule::Kind::kMask) {
        SPLATLAS_ASSIGN_OR_RETURN(const VoxelBuffer mask, import_on_grid(rule.mask, "segment", rule.name));
        segment.mask = mask_of(mask);
      } else if (files_.volume.empty()) {
        return fail(ErrorCode::kUsage, "--segment \"{}\": {} needs a --volume", rule.name,
                    rule.kind == SegmentRule::Kind::kIsosurface ? "an isosurface" : "a threshold");
      }
      model_.structures.push_back({.name = rule.name, .color = rule.color});
      model_.segments.push_back(std::move(segment));
    }
    // Without labels, start with empty memberships on the grid of the volume or the first mask.
    if (files_.labels.empty() && model_.source_grid.voxels() > 0)
      model_.memberships = MembershipVolume(model_.storage_grid().size);
    return {};
  }

  /// The voxels of an image in storage order, on the grid of the other files or the first. Notes `item` if
  /// they are resampled.
  Result<VoxelBuffer> import_on_grid(const fs::path& file, const std::string& role, const std::string& item) {
    SPLATLAS_ASSIGN_OR_RETURN(Image image, import_image(file, {.spacing_mm = files_.spacing_mm}, notes_));
    if (model_.source_grid.voxels() == 0) model_.source_grid = image.grid;
    if (!have_same_voxels(model_.source_grid, image.grid)) {
      if (!(overlap(image.grid, model_.source_grid) > 0))
        return bad_file(file, "lies outside the grid of the other files");
      notes_.add("resampled-segment-masks", item);
      image.voxels = resample_nearest(image.voxels, image.grid, model_.source_grid);
      image.grid = model_.source_grid;
    }
    SPLATLAS_RETURN_IF_ERROR(remember(role, file));
    return to_storage_order(std::move(image.voxels), image.grid);
  }

  Result<void> import_meshes() {
    if (files_.meshes.empty()) return {};
    std::vector<TriangleMesh> meshes;
    ImportedLabels surfaces;  // as masks, which have no labels
    const std::optional<MmBox> labelled = labelled_box(model_);
    for (const MeshSource& source : files_.meshes) {
      SPLATLAS_ASSIGN_OR_RETURN(TriangleMesh mesh, place_mesh(source, labelled, notes_));
      if (mesh.dropped > 0) {
        notes_.add("degenerate-triangles", fmt::format("{} ({} of {})", source.file.string(), mesh.dropped,
                                                       mesh.dropped + mesh.triangles.size()));
      }
      if (labelled) note_size(model_, source, mesh, *labelled, notes_);
      meshes.push_back(std::move(mesh));
      surfaces.structures.emplace_back().name = source.name;
    }
    SPLATLAS_RETURN_IF_ERROR(apply_names(surfaces, "the surfaces"));
    notes_.add(surfaces.notes);
    SPLATLAS_RETURN_IF_ERROR(fit_grid(model_, meshes, files_.fit_grid, notes_));
    for (std::size_t n = 0; n < meshes.size(); ++n)
      SPLATLAS_RETURN_IF_ERROR(add_mesh(files_.meshes[n], meshes[n], std::move(surfaces.structures[n])));
    return {};
  }

  Result<void> add_mesh(const MeshSource& source, const TriangleMesh& mesh, SourceStructure structure) {
    Result<ClippedMesh> clipped = clip_mesh(mesh, model_.storage_grid());
    if (!clipped) return fail(clipped.error().code, "{}: {}", source.file.string(), clipped.error().message);
    if (clipped->crossed.empty()) {
      const MmBox from = box_of(mesh), to = *labelled_box(model_);
      return bad_file(source.file,
                      "lies from ({:.5g}) to ({:.5g}) mm in LPS, outside the volume, whose labels lie from "
                      "({:.5g}) to ({:.5g}); "
                      "check its frame (frame=ras or frame=lps) and scale, or widen the grid by --fit-grid",
                      fmt::join(from.low, ", "), fmt::join(from.high, ", "), fmt::join(to.low, ", "),
                      fmt::join(to.high, ", "));
    }
    constexpr double kNegligible = 1e-6;
    if (clipped->outside > kNegligible)
      notes_.add("surfaces-outside",
                 fmt::format("{} ({:.1f} %)", source.file.string(), 100 * clipped->outside));
    if (source.color) structure.color = source.color;
    structure.external = true;
    model_.structures.push_back(std::move(structure));
    model_.meshes.push_back(std::move(*clipped));
    return remember("mesh", source.file);
  }

  const SourceFiles& files_;
  Notes& notes_;
  const std::function<void(double)>& progress_;
  SourceModel model_;
  std::optional<Image> volume_;
  std::optional<NamesTable> names_;
  std::string labels_source_;
  std::size_t labels_frame_ = 0;
  std::optional<Error> error_;                         // the first one
  std::map<std::string, std::string> option_of_name_;  // by name_key
};

/// Replaces folders of surfaces and of BrainGlobe by their files.
Result<SourceFiles> without_folders(SourceFiles files) {
  for (const MeshSource& given : std::exchange(files.meshes, {})) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<MeshSource> surfaces, surfaces_of(given));
    files.meshes.insert(files.meshes.end(), surfaces.begin(), surfaces.end());
  }
  if (is_brainglobe_folder(files.volume)) files.volume /= "reference.tiff";
  const auto open_labels = [&files](fs::path& labels) {
    if (!is_brainglobe_folder(labels)) return;
    if (files.names.empty()) files.names = labels / "structures.json";
    labels /= "annotation.tiff";
  };
  open_labels(files.labels);
  for (LabelsFile& more : files.more_labels) open_labels(more.file);
  return files;
}

}  // namespace

LabelsFile parse_labels(const std::string& text) {
  std::error_code error;
  const std::size_t equals = text.find_first_of("=/");
  if (fs::exists(text, error) || equals == 0 || equals == std::string::npos || text[equals] == '/')
    return {"", text};
  return {std::string(trimmed(text.substr(0, equals))), text.substr(equals + 1)};
}

Result<SourceModel> import_sources(const SourceFiles& files, Notes& notes,
                                   const std::function<void(double)>& progress) {
  if (files.labels.empty() && files.segments.empty() && files.meshes.empty())
    return fail(ErrorCode::kUsage, "no structures: give --labels, a --segment or a --mesh");
  const auto lacks_name = [&files](const LabelsFile& more) {
    return more.file.empty() || more.group.empty() || files.labels_group.empty();
  };
  if (const auto one = std::ranges::find_if(files.more_labels, lacks_name); one != files.more_labels.end())
    return fail(ErrorCode::kUsage, "--labels {}: one of several label maps must be NAME=FILE",
                in_quotes((files.labels_group.empty() ? files.labels : one->file).string()));
  if (!files.names.empty() && files.labels.empty() && files.meshes.empty())
    return fail(ErrorCode::kUsage, "--names needs --labels or a --mesh");
  SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles single, without_folders(files));
  return SourceImporter(single, notes, progress).import();
}

}  // namespace splatlas
