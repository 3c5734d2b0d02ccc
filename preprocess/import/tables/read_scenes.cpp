#include "preprocess/import/tables/read_scenes.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "format/content/cut_planes.h"
#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

constexpr double kMaxZoom = 1000;
constexpr std::size_t kMaxSceneText = 4000;
constexpr const ViewAngles& kSuperior = kViewAngles[static_cast<std::size_t>(NamedView::kSuperior)];
constexpr std::string_view kKeys =
    "name, select, question, caption, view, azimuth, elevation, zoom, projection, center, cuts and labels";

/// The reader of one table [[scene]]. Keeps the first error.
class SceneReader {
 public:
  SceneReader(const std::filesystem::path& path, const toml::table& table) : path_(path), table_(table) {}

  [[nodiscard]] Result<Scene> read() {
    Scene scene;
    for (const auto& [key, value] : table_) {
      const std::string_view name = key.str();
      if (name == "name") {
        scene.name = text(value, name);
      } else if (name == "select") {
        scene.selection = text(value, name);
      } else if (name == "question") {
        scene.question = text(value, name);
      } else if (name == "caption") {
        scene.caption = text(value, name, /*has_lines=*/true);
      } else if (name == "view") {
        set_view(value, scene);
      } else if (name == "azimuth") {
        scene.azimuth_deg = number(value, name, -360, 360);
      } else if (name == "elevation") {
        scene.elevation_deg = number(value, name, -90, 90);
      } else if (name == "zoom") {
        scene.zoom = number(value, name, 1 / kMaxZoom, kMaxZoom);
      } else if (name == "center") {
        scene.center = center(value);
      } else if (name == "cuts") {
        scene.cuts = cuts(value);
      } else if (name == "projection") {
        scene.perspective = is_perspective(value);
      } else if (name == "labels") {
        scene.labels = texts(value, "labels", "[\"Putamen_L\", \"Caudate_*\"]");
      } else {
        refuse(value, fmt::format("unknown key {}; a scene has {}", in_quotes(name), kKeys));
      }
    }
    if (scene.elevation_deg == 90 && !table_.contains("azimuth")) scene.azimuth_deg = kSuperior.azimuth_deg;
    if (scene.name.empty()) refuse(table_, "the scene has no name; add name = \"...\"");
    if (trimmed(scene.name) != scene.name)
      refuse(table_, fmt::format("name {} begins or ends with a blank; remove it", in_quotes(scene.name)));
    if (scene.selection.empty())
      refuse(table_, fmt::format("scene {} has no selection; add select = \"...\"", in_quotes(scene.name)));
    if (error_) return tl::unexpected(*error_);
    return scene;
  }

 private:
  void refuse(const toml::node& at, const std::string& what) {
    if (error_) return;
    error_ = Error{
        ErrorCode::kFailed, fmt::format("{}: line {}: {}", path_.string(), at.source().begin.line, what), {}};
  }
  [[nodiscard]] std::string text(const toml::node& value, std::string_view key, bool has_lines = false) {
    const auto found = value.value<std::string>();
    if (!found) refuse(value, fmt::format("{} must be a text in quotes", key));
    std::string text = found.value_or("");
    if (has_lines) text = std::string(trimmed(text));
    std::string line = text;
    if (has_lines) std::ranges::replace(line, '\n', ' ');
    if (printable(line) != line)
      refuse(value, fmt::format("{} must be {} of visible UTF-8 characters; remove {}characters for control "
                                "or direction",
                                key, has_lines ? "lines" : "one line", has_lines ? "" : "line breaks, and "));
    if (text.size() > kMaxSceneText)
      refuse(value, fmt::format("{} has {} bytes; {} are allowed", key, text.size(), kMaxSceneText));
    return text;
  }
  [[nodiscard]] std::string center(const toml::node& value) {
    std::string center = text(value, "center");
    if (!parse_center(center)) {
      refuse(value, fmt::format("center {} must be \"X,Y,Z\" in LPS mm, each at most {} from 0, or name a "
                                "structure",
                                in_quotes(center), kMaxMm));
    }
    return center;
  }
  /// The angles of a named view.
  void set_view(const toml::node& value, Scene& scene) {
    const std::string name = text(value, "view");
    const auto* const view = std::ranges::find(kViewAngles, name, &ViewAngles::name);
    if (view == kViewAngles.end()) {
      refuse(value, fmt::format("view {} must be anterior, posterior, left, right, superior or inferior",
                                in_quotes(name)));
    } else if (table_.contains("azimuth") || table_.contains("elevation")) {
      refuse(value, "a scene with a view has no azimuth and no elevation; remove them, or the view");
    } else {
      scene.azimuth_deg = view->azimuth_deg;
      scene.elevation_deg = view->elevation_deg;
    }
  }
  [[nodiscard]] bool is_perspective(const toml::node& value) {
    const std::string name = text(value, "projection");
    if (name != "parallel" && name != "perspective")
      refuse(value, fmt::format("projection {} must be parallel or perspective", in_quotes(name)));
    return name == "perspective";
  }
  [[nodiscard]] std::vector<std::string> texts(const toml::node& value, const char* key,
                                               const char* example) {
    std::vector<std::string> words;
    if (const toml::array* const list = value.as_array()) {
      for (const toml::node& one : *list) words.push_back(text(one, fmt::format("each of the {}", key)));
    } else {
      refuse(value, fmt::format("{0} must be a list of texts, as in {0} = {1}", key, example));
    }
    return words;
  }
  [[nodiscard]] std::string cuts(const toml::node& value) {
    const std::vector<std::string> words = texts(value, "cuts", "[\"left=10\", \"superior=40\"]");
    CutPlanes planes;
    for (const std::string& word : words) {
      const auto plane = parse_cut(word);
      if (!plane) refuse(value, fmt::format("cut {} {}", in_quotes(word), kCutForms));
      const Result<void> added = plane ? planes.add(*plane) : Result<void>();
      if (!added) refuse(value, added.error().message);
    }
    return fmt::format("{}", fmt::join(words, " "));
  }
  [[nodiscard]] double number(const toml::node& value, std::string_view key, double low, double high) {
    const auto found = value.value<double>();
    if (!found || !(*found >= low && *found <= high)) {
      const std::string given =
          fmt::format(" {}", found ? fmt::to_string(*found) : in_quotes(value.value_or(std::string())));
      refuse(value, fmt::format("{}{} must be a number from {} to {}", key, given, low, high));
    }
    return found.value_or(0);
  }

  const std::filesystem::path& path_;
  const toml::table& table_;
  std::optional<Error> error_;
};

}  // namespace

Result<SceneFile> read_scenes(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::string text, read_text(path));
  toml::table document;
  try {
    document = toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    return fail(ErrorCode::kFailed, "{}: line {}: {}", path.string(), error.source().begin.line,
                std::string(error.description()));
  }
  for (const auto& [key, value] : document) {
    if (key != "scene" || !value.is_array_of_tables()) {
      return fail(ErrorCode::kFailed, "{}: line {}: {} is no [[scene]]; a scene is a table [[scene]] with {}",
                  path.string(), key.source().begin.line, in_quotes(key.str()), std::string(kKeys));
    }
  }
  SceneFile file{path, {}};
  const toml::array* const scenes = document["scene"].as_array();
  if (scenes == nullptr) return fail(ErrorCode::kFailed, "{}: has no [[scene]]", path.string());
  for (const toml::node& table : *scenes) {
    SPLATLAS_ASSIGN_OR_RETURN(Scene scene, SceneReader(path, *table.as_table()).read());
    const auto same = [&](const Scene& other) { return equal_ignoring_case(other.name, scene.name); };
    if (std::ranges::any_of(file.scenes, same)) {
      return fail(ErrorCode::kFailed, "{}: line {}: two scenes have the name {}, ignoring case; rename one",
                  path.string(), table.source().begin.line, in_quotes(scene.name));
    }
    file.scenes.push_back(std::move(scene));
  }
  return file;
}

Result<std::vector<SceneFile>> read_scenes(const std::vector<std::filesystem::path>& paths) {
  std::vector<SceneFile> files;
  std::set<std::string> names;
  for (const std::filesystem::path& path : paths) {
    SPLATLAS_ASSIGN_OR_RETURN(SceneFile file, read_scenes(path));
    for (const Scene& scene : file.scenes) {
      if (names.insert(to_lower(scene.name)).second) continue;
      return fail(ErrorCode::kFailed, "{}: scene {}: another file has one of this name; rename one",
                  path.string(), in_quotes(scene.name));
    }
    files.push_back(std::move(file));
  }
  return files;
}

Result<std::vector<Scene>> scenes_of(const std::vector<SceneFile>& files, const StructureGraph& graph) {
  const auto check = [&](const Scene& scene) -> Result<void> {
    SPLATLAS_RETURN_IF_ERROR(Selection::parse(scene.selection, graph));
    const auto center = parse_center(scene.center);
    if (center && std::holds_alternative<std::string>(*center))
      SPLATLAS_RETURN_IF_ERROR(graph.find_named(scene.center));
    for (const std::string& label : scene.labels) SPLATLAS_RETURN_IF_ERROR(graph.find_named(label));
    return {};
  };
  std::vector<Scene> scenes;
  for (const SceneFile& file : files) {
    for (const Scene& scene : file.scenes) {
      if (const Result<void> checked = check(scene); !checked) {
        return fail(ErrorCode::kFailed, "{}: scene {}: {}", file.path.string(), in_quotes(scene.name),
                    checked.error().message);
      }
      scenes.push_back(scene);
    }
  }
  return scenes;
}

}  // namespace splatlas
