// Program splatlas-preprocess: builds and checks atlases, exports their parts, and gives them other scenes.

#include <algorithm>
#include <iterator>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "format/io/memory_limit.h"
#include "format/io/output_file.h"
#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/commands/commands.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

constexpr const char* kTool = "splatlas-preprocess " SPLATLAS_VERSION;

constexpr const char* kDescription =
#include "preprocess/commands/description.txt"
    ;

/// `first`: the first word of the command line, or "". `fault`: CLI11's message.
tl::unexpected<Error> wrong_usage(const CLI::App& app, const std::string& first, const std::string& fault) {
  if (!app.get_subcommands().empty()) {
    return fail(ErrorCode::kUsage, "{}; see splatlas-preprocess {} --help", fault,
                app.get_subcommands().front()->get_name());
  }
  if (first.empty()) {
    return fail(
        ErrorCode::kUsage,
        "no command is given; there are build, check, export and lesson; see splatlas-preprocess --help");
  }
  return fail(ErrorCode::kUsage,
              "{}: no such {}; there are build, check, export and lesson; see splatlas-preprocess --help",
              in_quotes(first), first.starts_with('-') ? "option" : "command");
}

/// The words of the command line, the last first. "@FILE" stands for those in a file: with quotes as in a
/// shell, and comments in lines that begin with "#".
Result<std::vector<std::string>> words_of(std::span<char* const> arguments) {
  std::vector<std::string> words;
  for (const std::string_view word : arguments.subspan(1)) {
    if (word.starts_with('@')) {
      SPLATLAS_ASSIGN_OR_RETURN(const std::string text, read_text(word.substr(1)));
      for (const TextLine& line : lines_of(text))
        std::ranges::move(CLI::detail::split_up(line.text), std::back_inserter(words));
    } else {
      words.emplace_back(word);
    }
  }
  return std::vector(words.rbegin(), words.rend());
}

Result<void> run(int argc, char** argv) {
  SPLATLAS_ASSIGN_OR_RETURN(std::vector<std::string> words, words_of({argv, static_cast<std::size_t>(argc)}));
  const std::string first = words.empty() ? std::string() : words.back();

  CLI::App app{kDescription, "splatlas-preprocess"};
  app.set_version_flag("--version", std::string(kTool) + " (atlas format 1)");
  app.get_formatter()->column_width(30);
  app.require_subcommand(1);
  BuildRequest request;
  request.options.tool = kTool;
  CheckRequest check_request;
  ExportOptions export_options;
  LessonRequest lesson_request;
  const CLI::App* build = add_build(app, request);
  const CLI::App* check = add_check(app, check_request);
  const CLI::App* lesson = add_lesson(app, lesson_request);
  add_export(app, export_options);
  try {
    app.parse(std::move(words));
  } catch (const CLI::Success& help_or_version) {
    std::ostringstream text;
    app.exit(help_or_version, text);
    return print_text(PrintableText::of_layout(text.str()));
  } catch (const CLI::ValidationError& error) {
    return fail(ErrorCode::kUsage, error.what());
  } catch (const CLI::ParseError& error) {
    return wrong_usage(app, first, fault_of_usage(app, error));
  }
  install_interrupt_handlers();
  const auto run_command = [&](const std::filesystem::path& file, const auto& command,
                               const auto& arguments) {
    return run_on_file(file, kOutOfMemoryRemedy, [&] { return command(arguments); });
  };
  SPLATLAS_RETURN_IF_ERROR(build->parsed()   ? run_command(request.options.output, run_build, request)
                           : check->parsed() ? run_command(check_request.atlas, run_check, check_request)
                           : lesson->parsed()
                               ? run_command(lesson_request.atlas, run_lesson, lesson_request)
                               : run_command(export_options.atlas, run_export, export_options));
  return finish_standard_output();
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) {
  return splatlas::run_main("splatlas-preprocess", [&] { return splatlas::run(argc, argv); });
}
