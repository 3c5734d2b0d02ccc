#include <array>

#include <CLI/CLI.hpp>

#include "format/atlas_reader.h"
#include "format/io/output_file.h"
#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "preprocess/commands/commands.h"
#include "preprocess/import/tables/read_scenes.h"

namespace splatlas {
namespace {

constexpr const char* kLessonExamples =
#include "preprocess/commands/lesson_help.txt"
    ;

}  // namespace

CLI::App* add_lesson(CLI::App& app, LessonRequest& request) {
  CLI::App* lesson = app.add_subcommand("lesson", "Copy an atlas with other scenes; needs no sources");
  lesson->footer(kLessonExamples);
  lesson->add_option("ATLAS", request.atlas, "atlas file; stays as it is")->required()->check(names_a_file());
  lesson
      ->add_option("--scene", request.scenes,
                   "TOML files with the scenes, in place of all scenes of the atlas (repeatable)")
      ->required()
      ->check(names_a_file());
  lesson->add_option("-o,--output", request.output, "atlas file to write")->required()->check(names_a_file());
  return lesson;
}

Result<void> run_lesson(const LessonRequest& request) {
  std::vector<std::filesystem::path> inputs = request.scenes;
  inputs.push_back(request.atlas);
  SPLATLAS_RETURN_IF_ERROR(check_outputs(std::array{request.output}, inputs));
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(request.output));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<SceneFile> files, read_scenes(request.scenes));
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(request.atlas));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Scene> scenes, scenes_of(files, atlas->graph()));
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(request.output));
  SPLATLAS_RETURN_IF_ERROR(
      atlas->copy_with_scenes(scenes, [&](std::span<const std::byte> bytes) { return file.write(bytes); }));
  SPLATLAS_RETURN_IF_ERROR(commit_files(std::span(&file, 1)));
  return print_text(
      PrintableText("{}: {} scene{}\n", request.output, scenes.size(), scenes.size() == 1 ? "" : "s"));
}

}  // namespace splatlas
