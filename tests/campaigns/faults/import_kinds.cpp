#include "tests/campaigns/faults/import_kinds.h"

#include <algorithm>
#include <map>

#include "format/text/ascii_text.h"
#include "preprocess/commands/commands.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/labels/import_labels.h"
#include "preprocess/import/meshes/import_mesh.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// How `result` ended. Its message and notes are reported as a build would.
template <typename T>
ImportEnd end_of(const Result<T>& result, const Notes& notes) {
  const std::string error = result ? "" : result.error().message;
  static_cast<void>(report_as_json(&notes, {}) + report_as_html(&notes, {}, "a.atlas"));
  if (result) return {};
  const auto says = [&](const char* text) { return error.find(text) != std::string::npos; };
  if (says("its reader crashed") || says("its reader gave up") || says("no whole answer"))
    return {Outcome::kCrashOfChild, error};
  if (says("which no valid file of its size does") || says("without progress"))
    return {Outcome::kLimitOfChild, error};
  return {Outcome::kRefusal, error};
}

const ImageOptions kOptions{.component = 1, .spacing_mm = Vec3{1, 1, 1}};

ImportEnd import_as_volume(const fs::path& path) {
  Notes notes;
  const Result<Image> image = import_image(path, kOptions, notes);
  if (image) static_cast<void>(to_storage_order(image->voxels, image->grid));
  return end_of(image, notes);
}

ImportEnd import_as_labels(const fs::path& path) {
  const Result<ImportedLabels> labels = import_labels(path, kOptions);
  return end_of(labels, labels ? labels->notes : Notes());
}

/// As labels; as a volume, too, unless the file is refused for a reason that concerns both.
ImportEnd import_pixels(const fs::path& path) {
  const ImportEnd end = import_as_labels(path);
  return end.outcome == Outcome::kRefusal ? import_as_volume(path) : end;
}

ImportEnd import_surface(const fs::path& path) {
  Notes notes;
  const MmBox box{{-10, -10, -10}, {10, 10, 10}};
  return end_of(place_mesh({.name = "a", .file = path}, box, notes), notes);
}

ImportEnd import_names(const fs::path& path) {
  Notes notes;
  return end_of(read_names(path, NamesFormat::kAuto, notes), notes);
}

ImportEnd import_tree(const fs::path& path) {
  Notes notes;
  return end_of(read_tree(path, notes), notes);
}

bool has_ending(const fs::path& file, const ImportKind& kind) {
  const std::string name = to_lower(file.filename().string());
  return std::ranges::any_of(kind.endings, [&](const std::string& ending) { return name.ends_with(ending); });
}

/// Headers and pixels of one image: "a.hdr" with "a.img". `names` are all names in the folder.
std::vector<fs::path> detached_parts(const fs::path& file, const std::vector<fs::path>& others) {
  const std::string ending = to_lower(file.extension().string());
  if (ending != ".hdr" && ending != ".img" && ending != ".mhd" && ending != ".nhdr") return {};
  std::vector<fs::path> parts;
  for (const fs::path& other : others) {
    if (other != file && other.stem().string().starts_with(file.stem().string())) parts.push_back(other);
  }
  return parts;
}

}  // namespace

const std::vector<ImportKind>& import_kinds() {
  static const std::vector<ImportKind> kKinds{
      {"NIfTI", {".nii", ".nii.gz", ".hdr", ".img"}, import_pixels},
      {"NRRD", {".nrrd", ".nhdr"}, import_pixels},
      {"MetaImage", {".mha", ".mhd"}, import_pixels},
      {"MGH", {".mgh", ".mgz"}, import_pixels},
      {"pictures", {".png", ".tif", ".tiff"}, import_pixels},
      {"picture stacks", {".png", ".tif", ".tiff"}, import_pixels, true},
      {"mask folders", {".nii.gz"}, import_as_labels, true},
      {"DICOM files", {".dcm"}, import_pixels},
      {"DICOM folders", {".dcm"}, import_pixels, true},
      {".vtk", {".vtk"}, import_surface},
      {".vtp", {".vtp"}, import_surface},
      {".stl", {".stl"}, import_surface},
      {".obj", {".obj"}, import_surface},
      {".ply", {".ply"}, import_surface},
      {".gii", {".gii"}, import_surface},
      {"FreeSurfer", {".pial"}, import_surface},
      {"names", {".txt", ".label", ".ctbl", ".csv", ".tsv", ".json"}, import_names},
      {"trees", {".json", ".csv", ".tsv", ".tree"}, import_tree}};
  return kKinds;
}

std::vector<Seed> find_seeds(const ImportKind& kind, const fs::path& folder) {
  constexpr std::uintmax_t kMostBytes = 4'000'000;
  std::map<fs::path, std::vector<fs::path>> folders;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.file_size() <= kMostBytes)
      folders[entry.path().parent_path()].push_back(entry.path());
  }
  std::vector<Seed> seeds;
  for (auto& [parent, files] : folders) {
    std::ranges::sort(files);
    std::vector<fs::path> of_kind;
    std::ranges::copy_if(files, std::back_inserter(of_kind),
                         [&](const fs::path& file) { return has_ending(file, kind); });
    if (kind.takes_folder && of_kind.size() < 2) continue;
    for (std::size_t n = 0; n < of_kind.size(); ++n) {
      Seed seed{of_kind[n], detached_parts(of_kind[n], files)};
      for (std::size_t m = 1; kind.takes_folder && m < std::min(of_kind.size(), kMostInFolder); ++m)
        seed.companions.push_back(of_kind[(n + m) % of_kind.size()]);
      seeds.push_back(std::move(seed));
    }
  }
  return seeds;
}

}  // namespace splatlas
