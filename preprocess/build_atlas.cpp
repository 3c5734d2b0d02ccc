#include "preprocess/build_atlas.h"

#include <fmt/format.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/interrupts.h"
#include "format/output_file.h"
#include "preprocess/build_content.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

Result<void> check_output(const fs::path& output, const SourceFiles& sources) {
  std::error_code error;
  for (const fs::path& input : list_files(sources)) {
    if (fs::equivalent(output, input, error) && !error) {
      return fail(ErrorCode::kFailed,
                  fmt::format("{}: is an input; the atlas needs a name of its own", output.string()));
    }
  }
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  if (fs::is_directory(output, error) || output.filename().empty()) {
    return fail(ErrorCode::kFailed, fmt::format("{}: is a folder; the atlas is a file", output.string()));
  }
  if (!fs::is_directory(folder, error)) {
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written: there is no folder {}",
                                                output.string(), folder.string()));
  }
  return {};
}

Result<BuildReport> report_on(const fs::path& output, std::uint64_t structures) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::shared_ptr<const Atlas> atlas, Atlas::open(output));
  BuildReport report;
  report.structures = structures;
  report.classes = atlas->classes().size();
  for (const Axis axis : kAxes) report.runs[static_cast<std::size_t>(axis)] = atlas->runs(axis);
  for (StructureIndex s = 0; s < structures; ++s) report.triangles += atlas->triangles(s);
  report.bytes = atlas->counters().file;
  return report;
}

}  // namespace

Result<BuildReport> build_atlas(const BuildOptions& options) {
  SPLATLAS_RETURN_IF_ERROR(check_output(options.output, options.sources));
  StageClock clock(options.progress);
  const auto update = [&](double fraction) { clock.update(fraction); };

  clock.begin("read", 0.1);
  SPLATLAS_ASSIGN_OR_RETURN(SourceModel model, import_sources(options.sources, update));
  std::vector<std::string> notes = model.notes;
  SPLATLAS_ASSIGN_OR_RETURN(AtlasContent content,
                            build_content(std::move(model), options.threads, clock, notes));
  content.provenance.title = options.title;
  content.provenance.citation = options.citation;
  content.provenance.licence = options.licence;
  content.provenance.tool = options.tool;

  clock.begin("write", 0.4);
  const WriteOptions writing{options.level, options.compact, options.threads, update};
  Result<std::vector<std::byte>> bytes = encode_atlas(content, writing);
  if (!bytes)
    return fail(bytes.error().code, fmt::format("{}: {}", options.output.string(), bytes.error().message));
  {
    const DeferInterrupts no_half_file;
    SPLATLAS_RETURN_IF_ERROR(write_file(options.output, *bytes));
  }
  clock.end();

  SPLATLAS_ASSIGN_OR_RETURN(BuildReport report, report_on(options.output, content.graph.size()));
  report.stages = clock.stages();
  report.notes = std::move(notes);
  return report;
}

}  // namespace splatlas
