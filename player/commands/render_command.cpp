#include "player/commands/render_command.h"

#include <chrono>
#include <cstddef>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/system/check_writable.h"
#include "format/system/output_file.h"
#include "format/system/output_path.h"
#include "format/system/result_macros.h"
#include "player/pictures/picture_encoder.h"

namespace splatlas {
namespace {

nlohmann::ordered_json missing_json(const Renderer& renderer) {
  auto json = nlohmann::ordered_json::array();
  for (const MissingPart& part : renderer.missing()) {
    json.push_back({{"structure", renderer.atlas().graph()[part.structure].id},
                    {"part", part.surface ? "surface" : "volume"},
                    {"voxels", part.voxels},
                    {"why", part.error.message}});
  }
  return json;
}

nlohmann::ordered_json stats_json(const Renderer& renderer, double open_ms) {
  const RenderStats& stats = renderer.stats();
  const Atlas::Counters bytes = renderer.atlas().counters();
  return {
      {"voxels",
       {{"volume", stats.volume_voxels}, {"surface", stats.surface_voxels}, {"hybrid", stats.hybrid_voxels}}},
      {"occupancy", stats.occupancy},
      {"runs_visited", stats.runs_visited},
      {"voxels_visited", stats.voxels_visited},
      {"triangles", stats.triangles},
      {"bytes", {{"file", bytes.file}, {"read", bytes.read}, {"decoded", bytes.decoded}}},
      {"ms",
       {{"open", open_ms},
        {"select", stats.select_ms},
        {"decode", stats.decode_ms},
        {"render", stats.render_ms}}},
      {"missing", missing_json(renderer)}};
}

Result<OutputFile> written(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path));
  SPLATLAS_RETURN_IF_ERROR(file.write(bytes));
  return file;
}

/// Writes both files or none.
Result<void> write_outputs(const RenderRequest& request, std::span<const std::byte> picture,
                           const std::string& stats) {
  std::vector<OutputFile> files;
  if (!request.stats.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, written(request.stats, std::as_bytes(std::span(stats))));
    files.push_back(std::move(file));
  }
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, written(request.output, picture));
  files.push_back(std::move(file));
  return commit_files(files);
}

}  // namespace

Result<std::vector<std::string>> run_render(const RenderRequest& request) {
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_ending(request.output));
  SPLATLAS_RETURN_IF_ERROR(
      check_outputs(std::vector{request.output, request.stats}, std::vector{request.atlas}));
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(request.output));
  if (!request.stats.empty()) SPLATLAS_RETURN_IF_ERROR(check_writable_file(request.stats));
  // Report errors that do not need the atlas before opening it.
  SPLATLAS_ASSIGN_OR_RETURN(const auto terms, parse_selection(request.select));
  SPLATLAS_RETURN_IF_ERROR(view_of(request.camera, request.options.size, Display{}));
  SPLATLAS_RETURN_IF_ERROR(
      PictureEncoder::check_size(request.output, request.options.size, request.background));

  const auto start = std::chrono::steady_clock::now();
  SPLATLAS_ASSIGN_OR_RETURN(std::shared_ptr<const Atlas> atlas, Atlas::open(request.atlas));
  const double open_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, resolve_selection(terms, atlas->graph()));

  PictureEncoder encoder(request.output);
  Renderer renderer(std::move(atlas), {.threads = request.threads});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  SPLATLAS_ASSIGN_OR_RETURN(const Picture picture, renderer.render(request.camera, request.options));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, encoder.encode(picture, request.background));
  SPLATLAS_RETURN_IF_ERROR(write_outputs(request, bytes, stats_json(renderer, open_ms).dump(2) + "\n"));
  std::vector<std::string> missing;
  for (const MissingPart& part : renderer.missing()) {
    missing.push_back(describe(part, renderer.atlas().graph()));
  }
  return missing;
}

}  // namespace splatlas
