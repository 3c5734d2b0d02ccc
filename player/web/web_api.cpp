#include "player/web/web_api.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "format/io/input_file.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/json_text.h"
#include "player/camera_moves.h"
#include "player/renderer.h"
#include "player/web/info_json.h"
#include "player/web/remote_bytes.h"
#include "player/web/render_warnings.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

/// The module's state.
struct WebPlayer {
  std::vector<std::byte> input;
  std::string text;
  std::shared_ptr<RemoteBytes> remote;  // of the atlas that is open, or is being opened
  std::optional<Renderer> renderer;
  Selection selection;
  Camera camera;
  RenderOptions options;
  Frame frame;
  std::vector<std::uint8_t> pixels;
};

WebPlayer& player() {
  static WebPlayer player;
  return player;
}

/// Takes the value or message of body() as text. Returns the status of a call.
template <typename Body>
int answer(const Body& body) {
  const auto failed = [](ErrorCode code, const char* message) {
    player().text = message;
    return 1 + static_cast<int>(code);
  };
  try {
    Result<std::string> text = body();
    if (!text) return failed(text.error().code, text.error().message.c_str());
    player().text = *std::move(text);
    return 0;
  } catch (const std::bad_alloc&) {
    return failed(ErrorCode::kLimit, "out of memory");
  } catch (const std::exception& error) {
    return failed(ErrorCode::kFailed, error.what());
  }
}

std::string line_of(const Json& json) {
  return json_text(json, -1);
}

constexpr const char* kAtlasName = "atlas";

void close() {
  player().frame = {};
  player().renderer.reset();
  player().selection = {};
}

/// Opens an atlas. Nothing is selected.
void play(std::shared_ptr<const Atlas> atlas) {
  player().renderer.emplace(std::move(atlas), RendererOptions{.threads = 1});
  player().camera = {};
  player().options = {};
}

Result<Renderer*> open_renderer() {
  if (player().renderer) return &*player().renderer;
  return fail(ErrorCode::kUsage, "no atlas is open");
}

Json camera_json(const Camera& camera) {
  Json json{{"azimuth", camera.azimuth_deg}, {"elevation", camera.elevation_deg}, {"zoom", camera.zoom}};
  if (camera.center_lps_mm) json["center"] = *camera.center_lps_mm;
  json["projection"] = camera.projection == CameraProjection::kParallel ? "parallel" : "perspective";
  json["fieldOfView"] = camera.field_of_view_deg;
  return json;
}

/// Selects. Returns warnings.
Result<Json> select(Renderer& renderer, std::string_view text) {
  const TaskControl task({}, {}, &renderer.atlas().work_budget());
  SPLATLAS_ASSIGN_OR_RETURN(const auto terms, parse_selection(text));
  SPLATLAS_ASSIGN_OR_RETURN(Selection selection, resolve_selection(terms, renderer.atlas().graph()));
  SPLATLAS_ASSIGN_OR_RETURN(const auto warnings, selection_warnings(terms, renderer.atlas()));
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  player().selection = std::move(selection);
  return Json(warnings);
}

Json drawn_json(const Selection& selection) {
  Json json = Json::array();
  for (const StructureDraw& draw : selection.structures) {
    const bool is_ghost = draw.mode == DrawMode::kSurface && draw.ghost;
    Json entry = Json::array({is_ghost ? "ghost" : name_of(draw.mode)});
    if (draw.mode != DrawMode::kOff) {
      entry.push_back(draw.opacity ? Json(*draw.opacity) : Json());
      entry.push_back(to_hex(draw.color));
    }
    json.push_back(std::move(entry));
  }
  return json;
}

/// Fits the camera to the selection, or to its part in a structure, and zooms by `zoom`.
Result<void> fit(Renderer& renderer, const PictureSize& size, std::optional<StructureIndex> structure,
                 double zoom) {
  Camera& camera = player().camera;
  RenderOptions options = player().options;
  options.size = size;
  options.quality = Quality::kDraft;
  std::vector<StructureIndex> part;
  if (structure) part = renderer.atlas().graph().descendants(*structure);
  const auto of = structure ? std::optional<std::span<const StructureIndex>>(part) : std::nullopt;
  SPLATLAS_ASSIGN_OR_RETURN(camera, renderer.fit(camera, options, of));
  camera = zoomed(camera, zoom);
  return {};
}

Result<std::string> show_scene(std::uint32_t n, const PictureSize& size) {
  SPLATLAS_ASSIGN_OR_RETURN(Renderer* const renderer, open_renderer());
  const std::vector<Scene>& scenes = renderer->atlas().scenes();
  if (n >= scenes.size())
    return fail(ErrorCode::kNotFound, "scene {}: the atlas has {} scenes", n, scenes.size());
  const Scene& scene = scenes[n];
  SPLATLAS_ASSIGN_OR_RETURN(const SceneFraming framing, framing_of(scene, renderer->atlas()));
  SPLATLAS_ASSIGN_OR_RETURN(const Json warnings, select(*renderer, scene.selection));
  player().camera = {.azimuth_deg = scene.azimuth_deg, .elevation_deg = scene.elevation_deg};
  player().options.cuts = framing.cuts;
  SPLATLAS_RETURN_IF_ERROR(fit(*renderer, size, std::nullopt, scene.zoom));
  if (framing.center_lps_mm) player().camera.center_lps_mm = framing.center_lps_mm;
  return line_of({{"name", scene.name},
                  {"question", scene.question},
                  {"caption", scene.caption},
                  {"select", scene.selection},
                  {"camera", camera_json(player().camera)},
                  {"warnings", warnings}});
}

Result<std::string> render(const PictureSize& size, std::int32_t quality) {
  SPLATLAS_ASSIGN_OR_RETURN(Renderer* const renderer, open_renderer());
  if (quality < 0 || quality > static_cast<std::int32_t>(Quality::kHigh))
    return fail(ErrorCode::kUsage, "quality: {}: must be 0, 1 or 2", quality);
  RenderOptions& options = player().options;
  options.size = size;
  options.quality = static_cast<Quality>(quality);
  Frame& frame = player().frame;
  Result<void> rendered = renderer->render(player().camera, options, frame);
  if (!rendered) {
    frame = {};
    return tl::unexpected(std::move(rendered).error());
  }
  Json missing = Json::array();
  for (const MissingPart& part : frame.missing) missing.push_back(describe(part, renderer->atlas().graph()));
  return line_of(missing);
}

Result<std::string> pick(double x, double y) {
  SPLATLAS_ASSIGN_OR_RETURN(const Renderer* const renderer, open_renderer());
  const std::optional<Pick> picked = player().frame.pick(x, y);
  if (!picked) return line_of(nullptr);
  const StructureGraph& graph = renderer->atlas().graph();
  return line_of({{"index", picked->structure},
                  {"id", graph[picked->structure].id},
                  {"name", graph[picked->structure].name},
                  {"path", graph.paths(picked->structure, 1).front()},
                  {"point", picked->point_lps_mm}});
}

std::string stats_text(const RenderStats& stats) {
  return line_of({{"volume_voxels", stats.volume_voxels},
                  {"surface_voxels", stats.surface_voxels},
                  {"hybrid_voxels", stats.hybrid_voxels},
                  {"runs_visited", stats.runs_visited},
                  {"voxels_visited", stats.voxels_visited},
                  {"triangles", stats.triangles},
                  {"level", stats.level},
                  {"surface_level", stats.surface_level},
                  {"ms",
                   {{"select", stats.select_ms},
                    {"decode", stats.decode_ms},
                    {"render", stats.render_ms},
                    {"traversal", stats.traversal.wall_ms},
                    {"rasterize", stats.rasterize.wall_ms},
                    {"sheets", stats.sheets.wall_ms},
                    {"resolve", stats.resolve.wall_ms},
                    {"depth_cue", stats.depth_cue.wall_ms}}}});
}

std::string take_input_text() {
  const std::vector<std::byte> input = std::exchange(player().input, {});
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

}  // namespace
}  // namespace splatlas

using namespace splatlas;  // NOLINT(google-build-using-namespace): C functions stand in no namespace

std::uint8_t* splatlas_input(std::uint32_t bytes) try {
  player().input.assign(std::size_t{bytes} + 1, std::byte{});  // never null
  player().input.pop_back();
  return reinterpret_cast<std::uint8_t*>(player().input.data());
} catch (const std::exception&) {
  return nullptr;
}

const char* splatlas_text() {
  return player().text.data();
}
std::uint32_t splatlas_text_bytes() {
  return static_cast<std::uint32_t>(player().text.size());
}

int splatlas_open() {
  return answer([]() -> Result<std::string> {
    close();
    player().remote.reset();
    SPLATLAS_ASSIGN_OR_RETURN(std::shared_ptr<const Atlas> atlas,
                              Atlas::open_bytes(std::exchange(player().input, {}), kAtlasName));
    play(std::move(atlas));
    return std::string();
  });
}

int splatlas_open_remote(double bytes) {
  return answer([&]() -> Result<std::string> {
    if (player().renderer || !player().remote) player().remote = std::make_shared<RemoteBytes>();
    close();
    const auto read = [remote = player().remote](std::uint64_t offset, std::span<std::byte> to) {
      return remote->read(offset, to);
    };
    SPLATLAS_ASSIGN_OR_RETURN(
        std::shared_ptr<const Atlas> atlas,
        Atlas::open_file(InputFile(static_cast<std::uint64_t>(bytes), read, kAtlasName)));
    play(std::move(atlas));
    return std::string();
  });
}

int splatlas_wanted() {
  return answer([]() -> Result<std::string> {
    Json ranges = Json::array();
    if (player().remote) {
      for (const ByteRange& range : player().remote->take_missed())
        ranges.push_back({range.offset, range.bytes});
    }
    return line_of(ranges);
  });
}

int splatlas_give(double offset) {
  return answer([&]() -> Result<std::string> {
    if (!player().remote) return fail(ErrorCode::kUsage, "no atlas on a server is open");
    player().remote->give(static_cast<std::uint64_t>(offset), std::exchange(player().input, {}));
    return std::string();
  });
}

int splatlas_info() {
  return answer([]() -> Result<std::string> {
    SPLATLAS_ASSIGN_OR_RETURN(const Renderer* const renderer, open_renderer());
    return info_json(renderer->atlas());
  });
}

int splatlas_select() {
  return answer([]() -> Result<std::string> {
    SPLATLAS_ASSIGN_OR_RETURN(Renderer* const renderer, open_renderer());
    SPLATLAS_ASSIGN_OR_RETURN(const Json warnings, select(*renderer, take_input_text()));
    return line_of(warnings);
  });
}

int splatlas_drawn() {
  return answer([]() -> Result<std::string> { return line_of(drawn_json(player().selection)); });
}

int splatlas_scene(std::uint32_t n, std::int32_t width, std::int32_t height) {
  return answer([&] { return show_scene(n, {width, height}); });
}

void splatlas_camera(double azimuth, double elevation, double zoom, std::int32_t has_center, double x,
                     double y, double z, std::int32_t is_perspective, double field_of_view) {
  player().camera = {
      .azimuth_deg = azimuth,
      .elevation_deg = elevation,
      .zoom = zoom,
      .center_lps_mm = has_center != 0 ? std::optional(Vec3{x, y, z}) : std::nullopt,
      .projection = is_perspective != 0 ? CameraProjection::kPerspective : CameraProjection::kParallel,
      .field_of_view_deg = field_of_view};
}

int splatlas_fit(std::int32_t width, std::int32_t height, std::int32_t structure) {
  return answer([&]() -> Result<std::string> {
    SPLATLAS_ASSIGN_OR_RETURN(Renderer* const renderer, open_renderer());
    const auto index = static_cast<StructureIndex>(structure);
    if (structure >= 0 && index >= renderer->atlas().graph().size())
      return fail(ErrorCode::kNotFound, "structure {}: the atlas has {}", structure,
                  renderer->atlas().graph().size());
    SPLATLAS_RETURN_IF_ERROR(
        fit(*renderer, {width, height}, structure < 0 ? std::nullopt : std::optional(index), 1));
    return line_of(camera_json(player().camera));
  });
}

void splatlas_clear_cuts() {
  player().options.cuts = {};
}

int splatlas_cut(double nx, double ny, double nz, double offset) {
  return answer([&]() -> Result<std::string> {
    SPLATLAS_RETURN_IF_ERROR(player().options.cuts.add({{nx, ny, nz}, offset}));
    return std::string();
  });
}

int splatlas_options(std::int32_t caps, std::int32_t depth_cue, std::int32_t is_shaded,
                     double draft_budget_ms) {
  return answer([&]() -> Result<std::string> {
    if (caps < 0 || caps > static_cast<std::int32_t>(CapMode::kNone))
      return fail(ErrorCode::kUsage, "caps: {}: must be from 0 to 3", caps);
    if (depth_cue < 0 || depth_cue > 1)
      return fail(ErrorCode::kUsage, "depth cue: {}: must be 0 or 1", depth_cue);
    RenderOptions& options = player().options;
    options.caps = static_cast<CapMode>(caps);
    options.depth_cue = static_cast<DepthCue>(depth_cue);
    options.hybrid_shading = is_shaded != 0;
    options.draft_budget_ms = draft_budget_ms;
    return std::string();
  });
}

int splatlas_render(std::int32_t width, std::int32_t height, std::int32_t quality) {
  return answer([&] { return render({width, height}, quality); });
}

const float* splatlas_floats() {
  return player().frame.picture.rgba.data();
}

const std::uint8_t* splatlas_pixels() try {
  const Picture& picture = player().frame.picture;
  player().pixels.resize(picture.rgba.size());
  return to_srgba8(picture, player().pixels) ? player().pixels.data() : nullptr;
} catch (const std::exception&) {
  return nullptr;
}

int splatlas_pick(double x, double y) {
  return answer([&] { return pick(x, y); });
}

int splatlas_stats() {
  return answer([]() -> Result<std::string> { return stats_text(player().frame.stats); });
}
