#include "player/commands/render_command.h"

#include <chrono>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "player/pictures/picture_file.h"

namespace splatlas {
namespace {

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
        {"render", stats.render_ms}}}};
}

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (file << text; !file.flush()) {
    file.close();
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written", path.string()));
  }
  return {};
}

}  // namespace

Result<void> run_render(const RenderRequest& request) {
  SPLATLAS_RETURN_IF_ERROR(PictureWriter::check_ending(request.output));
  // Whatever can be told without the atlas is told first.
  SPLATLAS_ASSIGN_OR_RETURN(const auto terms, parse_selection(request.select));
  SPLATLAS_RETURN_IF_ERROR(parallel_view(request.camera, request.options.size, Display{}));

  const auto start = std::chrono::steady_clock::now();
  SPLATLAS_ASSIGN_OR_RETURN(std::shared_ptr<const Atlas> atlas, Atlas::open(request.atlas));
  const double open_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, resolve_selection(terms, atlas->graph()));

  PictureWriter writer(request.output);
  Renderer renderer(std::move(atlas), {.threads = request.threads});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  SPLATLAS_ASSIGN_OR_RETURN(const Picture picture, renderer.render(request.camera, request.options));
  SPLATLAS_RETURN_IF_ERROR(writer.write(picture, request.background));
  if (request.stats.empty()) return {};
  return write_text(request.stats, stats_json(renderer, open_ms).dump(2) + "\n");
}

}  // namespace splatlas
