#include "player/web/server/lesson_file.h"

#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "format/content/selection.h"
#include "format/io/output_file.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "player/camera_moves.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

Scene scene_of(const Json& json) {
  return {.name = json.at("name"),
          .caption = json.at("caption"),
          .selection = json.at("select"),
          .azimuth_deg = json.at("azimuth"),
          .elevation_deg = json.at("elevation"),
          .zoom = json.at("zoom"),
          .question = json.at("question"),
          .cuts = fmt::format("{}", fmt::join(json.at("cuts").get<std::vector<std::string>>(), " ")),
          .center = json.value("center", ""),
          .perspective = json.at("projection") == "perspective",
          .labels = json.at("labels")};
}

Result<std::vector<Scene>> scenes_of(const std::string& text, const Atlas& atlas) try {
  std::vector<Scene> scenes;
  std::set<std::string> names;
  for (const Json& json : Json::parse(text).get<std::vector<Json>>()) {
    const Scene& scene = scenes.emplace_back(scene_of(json));
    if (scene.name.empty() || !names.insert(to_lower(scene.name)).second)
      return fail(ErrorCode::kUsage, "scene {} needs a name of its own", scenes.size());
    SPLATLAS_RETURN_IF_ERROR(Selection::parse(scene.selection, atlas.graph()));
    SPLATLAS_RETURN_IF_ERROR(framing_of(scene, atlas));
  }
  return scenes;
} catch (const Json::exception& error) {
  return fail(ErrorCode::kUsage, "no scenes: {}", error.what());
}

/// Another one once the file is written, or another one is in its place; none without a file.
LessonFile::Stamp stamp_of(const std::filesystem::path& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return {};
  return {static_cast<std::int64_t>(file.st_dev), static_cast<std::int64_t>(file.st_ino), file.st_size,
          file.st_mtim.tv_sec, file.st_mtim.tv_nsec};
}

}  // namespace

LessonFile::LessonFile(std::filesystem::path path, AtlasOptions options)
    : path_(std::move(path)), options_(options), stamp_(stamp_of(path_)) {}

Result<SavedLesson> LessonFile::save(const Atlas& atlas, const std::string& page, const std::string& scenes,
                                     bool replaces) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Scene> lesson, scenes_of(scenes, atlas));
  std::filesystem::path target = path_;
  const bool is_beside = !check_writable_file(target);
  if (is_beside) target.replace_extension(".lesson.atlas");
  const std::string name = target.filename().string();
  const Stamp before = stamp_of(target);
  const auto changed = [&] {
    return fail(ErrorCode::kFailed, "{} has changed on the disk: start the player again", name);
  };
  if (!is_beside && before != stamp_) return changed();
  const bool has_other = is_beside ? before != Stamp{} : !atlas.scenes().empty() && page != page_;
  if (has_other && !replaces)
    return SavedLesson{{}, fmt::format("Replace {} in {}?", is_beside ? "the atlas" : "the lesson", name)};
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(target));
  SPLATLAS_RETURN_IF_ERROR(
      atlas.copy_with_scenes(lesson, [&](std::span<const std::byte> bytes) { return file.write(bytes); }));
  if (before != stamp_of(target)) return changed();
  SPLATLAS_RETURN_IF_ERROR(commit_files(std::span(&file, 1)));
  SavedLesson saved{{}, fmt::format("The lesson is saved in {}.", name)};
  std::tie(path_, page_, stamp_) = std::tuple(target, page, stamp_of(target));
  SPLATLAS_ASSIGN_OR_RETURN(saved.atlas, Atlas::open(path_, options_));
  return saved;
}

}  // namespace splatlas
