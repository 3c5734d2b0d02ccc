#include "bench/scenes/atlases.h"

#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/build/build_atlas.h"
#include "tests/phantom/phantom_files.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// The folder may be removed on return: an open atlas needs no path.
Result<std::shared_ptr<const Atlas>> build_and_open(const SourceFiles& sources, const char* title,
                                                    const TemporaryFolder& folder,
                                                    const BenchOptions& options) {
  options.tell(fmt::format("building the atlas of {}", title));
  BuildOptions build;
  build.sources = sources;
  build.title = title;
  build.tool = "splatlas-bench";
  build.output = folder.path() / "bench.atlas";
  SPLATLAS_RETURN_IF_ERROR(build_atlas(build));
  return Atlas::open(build.output);
}

Result<void> check_installed(const std::filesystem::path& path) {
  if (std::error_code error; std::filesystem::exists(path, error)) return {};
  return fail(ErrorCode::kFailed,
              fmt::format("{}: is missing; install Debian's package mricron-data, or give an atlas with "
                          "--atlas",
                          path.string()));
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

std::filesystem::path templates_folder() {
  return "/usr/share/mricron/templates";
}

Result<SourceFiles> aal_sources() {
  SourceFiles sources;
  sources.labels = templates_folder() / "aal.nii.gz";
  sources.volume = templates_folder() / "ch2.nii.gz";
  sources.names = templates_folder() / "aal.nii.txt";
  for (const std::filesystem::path& path : {sources.labels, sources.volume, sources.names}) {
    SPLATLAS_RETURN_IF_ERROR(check_installed(path));
  }
  return sources;
}

Result<SourceFiles> colin27_sources() {
  SPLATLAS_ASSIGN_OR_RETURN(SourceFiles sources, aal_sources());
  const std::filesystem::path brain = templates_folder() / "ch2bet.nii.gz";
  SPLATLAS_RETURN_IF_ERROR(check_installed(brain));
  sources.tree = std::filesystem::path(SPLATLAS_SOURCE_DIR) / "preprocess/trees/colin27_aal.tree";
  for (const std::string& rule :
       {"Rest of brain=mask:" + brain.string(), std::string("Non-brain head=threshold:28:close=2")}) {
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
