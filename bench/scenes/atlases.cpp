#include "bench/scenes/atlases.h"

#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "tests/phantom/phantom_files.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {

Result<BuildReport> build_file(const SourceFiles& sources, const std::filesystem::path& output,
                               bool compact) {
  BuildOptions build;
  build.sources = sources;
  build.tool = "splatlas-bench";
  build.output = output;
  build.compact = compact;
  return build_atlas(build);
}

namespace {

const std::filesystem::path kTemplates = "/usr/share/mricron/templates";  // of mricron-data

/// The folder may be removed on return: an open atlas needs no path.
Result<std::shared_ptr<const Atlas>> build_and_open(const SourceFiles& sources, const char* title,
                                                    const TemporaryFolder& folder,
                                                    const BenchOptions& options) {
  options.tell(fmt::format("building the atlas of {}", title));
  const std::filesystem::path file = folder.path() / "bench.atlas";
  SPLATLAS_RETURN_IF_ERROR(build_file(sources, file));
  return Atlas::open(file);
}

}  // namespace

Result<std::shared_ptr<const Atlas>> open_phantom(const BenchOptions& options) {
  if (!options.atlas.empty()) return Atlas::open(options.atlas);
  const TemporaryFolder folder;
  SPLATLAS_RETURN_IF_ERROR(phantom::write_files(folder.path()));
  SourceFiles sources;
  sources.labels = folder.path() / "labels.nrrd";
  sources.volume = folder.path() / "volume.nrrd";
  sources.names = folder.path() / "names.txt";
  sources.tree = folder.path() / "phantom.tree";
  return build_and_open(sources, "the phantom", folder, options);
}

SourceFiles aal_sources() {
  SourceFiles sources;
  sources.labels = kTemplates / "aal.nii.gz";
  sources.volume = kTemplates / "ch2.nii.gz";
  sources.names = kTemplates / "aal.nii.txt";
  return sources;
}

Result<SourceFiles> colin27_sources() {
  SourceFiles sources = aal_sources();
  sources.tree = std::filesystem::path(SPLATLAS_SOURCE_DIR) / "preprocess/trees/colin27_aal.tree";
  for (const std::string& rule : {"Rest of brain=mask:" + (kTemplates / "ch2bet.nii.gz").string(),
                                  std::string("Non-brain head=threshold:28:close=2")}) {
    SPLATLAS_ASSIGN_OR_RETURN(SegmentRule segment, parse_segment(rule));
    sources.segments.push_back(std::move(segment));
  }
  return sources;
}

Result<std::shared_ptr<const Atlas>> open_colin27(const BenchOptions& options) {
  if (!options.atlas.empty()) return Atlas::open(options.atlas);
  SPLATLAS_ASSIGN_OR_RETURN(const SourceFiles sources, colin27_sources());
  const TemporaryFolder folder;
  return build_and_open(sources, "Colin 27", folder, options);
}

}  // namespace splatlas
