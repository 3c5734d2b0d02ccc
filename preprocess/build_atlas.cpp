#include "preprocess/build_atlas.h"

#include <array>
#include <cstddef>
#include <vector>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/system/check_writable.h"
#include "format/system/interrupts.h"
#include "format/system/output_file.h"
#include "format/system/output_path.h"
#include "format/system/result_macros.h"
#include "preprocess/build_content.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Reopens the encoded atlas before writing, so that an invalid one never replaces an old file.
Result<BuildReport> report_on(const std::vector<std::byte>& bytes, const fs::path& output,
                              std::uint64_t structures) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open_bytes(bytes, output.string()));
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
  SPLATLAS_RETURN_IF_ERROR(check_outputs(std::array{options.output}, list_files(options.sources)));
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(options.output));
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
  if (!bytes) return fail(bytes.error().code, "{}: {}", options.output.string(), bytes.error().message);
  SPLATLAS_ASSIGN_OR_RETURN(BuildReport report, report_on(*bytes, options.output, content.graph.size()));
  {
    const DeferInterrupts no_half_file;
    SPLATLAS_RETURN_IF_ERROR(write_file(options.output, *bytes));
  }
  clock.end();

  report.stages = clock.stages();
  report.notes = std::move(notes);
  return report;
}

}  // namespace splatlas
