// Commands of splatlas-preprocess: build, check, export and lesson; and the progress of a build.
#pragma once

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "preprocess/atlas/build_atlas.h"
#include "preprocess/check/examine_atlas.h"
#include "preprocess/export/export_atlas.h"

namespace CLI {
class App;
}

namespace splatlas {

enum class ProgressMode {
  kPercent,  ///< one line per stage, rewritten in place
  kLines,    ///< one line per stage when it has ended
  kJson,     ///< one JSON object per line
  kNone,
};

/// kPercent on a terminal, otherwise kLines.
[[nodiscard]] ProgressMode automatic_progress(std::FILE* stream);

class ProgressDisplay {
 public:
  ProgressDisplay(ProgressMode mode, std::FILE* stream) : mode_(mode), stream_(stream) {}

  /// Prints at most ten times a second, and always at the end of a stage.
  void show(const BuildProgress& progress);
  /// Ends an unfinished line, so that a message can follow.
  void finish();

 private:
  void show_percent(const BuildProgress& progress);
  void show_json(const BuildProgress& progress);

  ProgressMode mode_;
  std::FILE* stream_;
  bool line_open_ = false;
  std::string stage_;  // the last one shown
  std::chrono::steady_clock::time_point last_shown_;
};

/// Reports for programs and for people; empty paths for none.
struct ReportFiles {
  std::filesystem::path html, json;

  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  /// Adds the reports to the files of commit_files(). `notes`: of a build, or nullptr.
  [[nodiscard]] Result<void> add(const Notes* notes, const Examination& examination,
                                 const std::filesystem::path& atlas, std::vector<OutputFile>& added) const;
};

struct BuildRequest {
  BuildOptions options;
  ProgressMode progress = automatic_progress(stderr);
  ReportFiles reports;
};

struct CheckRequest {
  std::filesystem::path atlas;
  ReportFiles reports;
};

struct LessonRequest {
  std::filesystem::path atlas, output;
  std::vector<std::filesystem::path> scenes;
};

/// Adds a command. Parsing fills its second argument, which must outlive `app`. Invalid values throw
/// CLI::ValidationError with option, value and remedy.
CLI::App* add_build(CLI::App& app, BuildRequest& request);
CLI::App* add_check(CLI::App& app, CheckRequest& request);
CLI::App* add_export(CLI::App& app, ExportOptions& options);
CLI::App* add_lesson(CLI::App& app, LessonRequest& request);

/// Builds an atlas. Prints progress and notes to standard error, and a summary to standard output.
[[nodiscard]] Result<void> run_build(const BuildRequest& request);
/// Examines an atlas, writes reports, and prints a line per finding to standard output.
[[nodiscard]] Result<void> run_check(const CheckRequest& request);
/// Exports and prints a line per file to standard output.
[[nodiscard]] Result<void> run_export(const ExportOptions& options);
/// Copies an atlas with other scenes, chunks as they are stored, and prints a line to standard output.
[[nodiscard]] Result<void> run_lesson(const LessonRequest& request);

/// {"notes": [{"kind": "empty-masks", "warning": bool, "count": N, "message": "...", "items": [...]}],
/// "structures": [...], "findings": [...]}; without notes if `notes` is nullptr.
[[nodiscard]] std::string report_as_json(const Notes* notes, const Examination& examination);
/// The same as a page of its own, without scripts. `atlas` is named in its title.
[[nodiscard]] std::string report_as_html(const Notes* notes, const Examination& examination,
                                         const std::filesystem::path& atlas);
/// "12.5, -3, 40"
[[nodiscard]] std::string text_of_place(const Vec3& lps_mm);

}  // namespace splatlas
