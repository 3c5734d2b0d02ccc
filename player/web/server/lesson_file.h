// Lessons that a page saves into an atlas.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "format/atlas_reader.h"

namespace splatlas {

struct SavedLesson {
  std::shared_ptr<const Atlas> atlas;  ///< with the lesson, open; none: `text` asks whether to replace
  std::string text;                    ///< a line for the user
};

/// The file of an atlas that is played. A lesson is saved into it, or, if it cannot be written, into
/// NAME.lesson.atlas beside it, which takes its place then. No other file is touched. Not thread-safe.
class LessonFile {
 public:
  using Stamp = std::array<std::int64_t, 5>;

  /// To be made before the atlas is opened.
  LessonFile(std::filesystem::path path, AtlasOptions options);

  /// Saves the scenes of a page, as JSON with the keys of TOML, whole or not at all; sections other than the
  /// scenes are copied. Asks before it replaces a lesson that this page has not saved, or a file beside the
  /// atlas, unless `replaces`. kUsage for bad scenes; kFailed if the atlas has changed on the disk since, and
  /// errors of Atlas::copy_with_scenes() and OutputFile.
  [[nodiscard]] Result<SavedLesson> save(const Atlas& atlas, const std::string& page,
                                         const std::string& scenes, bool replaces);

 private:
  std::filesystem::path path_;
  AtlasOptions options_;
  Stamp stamp_;       ///< of the path, as it was opened or saved
  std::string page_;  ///< that has saved last
};

}  // namespace splatlas
