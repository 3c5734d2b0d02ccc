// Commands of splatlas-preprocess: build, export and lesson.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "preprocess/atlas/build_atlas.h"
#include "preprocess/commands/progress_display.h"
#include "preprocess/export/export_atlas.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Arguments of the build command.
struct BuildRequest {
  BuildOptions options;
  ProgressMode progress = automatic_progress(stderr);
  std::filesystem::path report, json;  ///< files for all notes; empty for none
};

/// Arguments of the lesson command.
struct LessonRequest {
  std::filesystem::path atlas, output;
  std::vector<std::filesystem::path> scenes;
};

/// Adds a command. Parsing fills its second argument, which must outlive `app`. Invalid values throw
/// CLI::ValidationError with option, value and remedy.
CLI::App* add_build(CLI::App& app, BuildRequest& request);
CLI::App* add_export(CLI::App& app, ExportOptions& options);
CLI::App* add_lesson(CLI::App& app, LessonRequest& request);

/// Builds an atlas. Prints progress and notes to standard error, and a summary to standard output.
[[nodiscard]] Result<void> run_build(const BuildRequest& request);
/// Exports and prints a line per file to standard output.
[[nodiscard]] Result<void> run_export(const ExportOptions& options);
/// Copies an atlas with other scenes, chunks as they are stored, and prints a line to standard output.
[[nodiscard]] Result<void> run_lesson(const LessonRequest& request);

// Reports of a build: all notes, for programs and for people.

/// {"notes": [{"kind": "empty-masks", "warning": bool, "count": N, "message": "...", "items": [...]}]}.
[[nodiscard]] std::string report_as_json(const Notes& notes);
/// A page of its own, without scripts. `atlas` is named in its title.
[[nodiscard]] std::string report_as_html(const Notes& notes, const std::filesystem::path& atlas);

}  // namespace splatlas
