// splatlas-web-scenes FOLDER: draws random scenes by the web API and by the renderer, which must agree to the
// bit, and writes each for the module's test: N.atlas, N.json, N.floats, the picture, and N.picks. Also
// phantom.atlas, lesson.atlas for a page, and hostile atlases.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/atlas_writer.h"
#include "player/web/web_api.h"
#include "tests/fuzz/mutators.h"
#include "tests/support/phantom_content.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint32_t kScenes = 100, kPicks = 4, kHostile = 400;

template <typename T>
void write_file(const std::filesystem::path& path, const T* data, std::size_t count) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
  if (!out.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

void give(const void* data, std::size_t bytes) {
  std::uint8_t* const input = splatlas_input(static_cast<std::uint32_t>(bytes));
  if (bytes > 0) std::memcpy(input, data, bytes);
}

std::string text() {
  return {splatlas_text(), splatlas_text_bytes()};
}

void require(int status) {
  if (status != 0) throw std::runtime_error(text());
}

/// A scene that the module can draw, and the options that its API has.
bool is_for_module(RandomScene& scene) {
  const RenderOptions& all = scene.options;
  scene.options = {.size = all.size,
                   .quality = all.quality,
                   .hybrid_shading = all.hybrid_shading,
                   .depth_cue = all.depth_cue,
                   .cuts = all.cuts,
                   .caps = all.caps};
  scene.camera.field_of_view_deg =
      std::min(scene.camera.field_of_view_deg, 50.0);  // above, surfaces may be refused
  return !scene.selection.empty();
}

bool is_perspective(const Camera& camera) {
  return camera.projection == CameraProjection::kPerspective;
}

/// The scene as JSON, for check_module.js.
Json json_of(const RandomScene& scene, const std::string& select) {
  const auto& [camera, options] = std::tie(scene.camera, scene.options);
  Json cuts = Json::array();
  for (const CutPlane& cut : options.cuts)
    cuts.push_back({{"normal", cut.normal_lps}, {"offset", cut.offset_mm}});
  Json json{{"select", select},
            {"camera",
             {{"azimuth", camera.azimuth_deg},
              {"elevation", camera.elevation_deg},
              {"zoom", camera.zoom},
              {"projection", is_perspective(camera) ? "perspective" : "parallel"},
              {"fieldOfView", camera.field_of_view_deg}}},
            {"cuts", cuts},
            {"caps", static_cast<int>(options.caps)},
            {"depthCue", options.depth_cue == DepthCue::kEdges},
            {"shading", options.hybrid_shading},
            {"quality", static_cast<int>(options.quality)},
            {"size", {options.size.width, options.size.height}}};
  if (camera.center_lps_mm) json["camera"]["center"] = *camera.center_lps_mm;
  return json;
}

/// Draws by the web API.
void draw(const RandomScene& scene, const Bytes& atlas, const std::string& select) {
  const auto& [camera, options] = std::tie(scene.camera, scene.options);
  give(atlas.data(), atlas.size());
  require(splatlas_open());
  give(select.data(), select.size());
  require(splatlas_select());
  const Vec3 center = camera.center_lps_mm.value_or(Vec3{});
  splatlas_camera(camera.azimuth_deg, camera.elevation_deg, camera.zoom, camera.center_lps_mm ? 1 : 0,
                  center[0], center[1], center[2], is_perspective(camera) ? 1 : 0, camera.field_of_view_deg);
  splatlas_clear_cuts();
  for (const auto& [n, offset] : options.cuts) require(splatlas_cut(n[0], n[1], n[2], offset));
  require(splatlas_options(static_cast<int>(options.caps), static_cast<int>(options.depth_cue),
                           options.hybrid_shading ? 1 : 0, 0));
  require(splatlas_render(options.size.width, options.size.height, static_cast<int>(options.quality)));
}

/// Draws and writes the n-th scene.
void write_scene(RandomScene& scene, std::uint32_t n, const std::filesystem::path& folder) {
  const Bytes atlas = value_or_throw(encode_atlas(scene.content));
  const std::string select = to_text(scene.selection, scene.content.graph);
  draw(scene, atlas, select);
  const std::size_t values =
      4 * static_cast<std::size_t>(scene.options.size.width * scene.options.size.height);

  Renderer renderer(value_or_throw(Atlas::open_bytes(atlas)), {.threads = 1});
  value_or_throw(renderer.select(value_or_throw(Selection::parse(select, scene.content.graph))));
  const Frame frame = value_or_throw(renderer.render(scene.camera, scene.options));
  if (!std::equal(frame.picture.rgba.begin(), frame.picture.rgba.end(), splatlas_floats()))
    throw std::runtime_error(fmt::format("scene {}: the web API draws another picture than the renderer", n));

  const auto path = [&](const char* ending) { return folder / fmt::format("{}.{}", n, ending); };
  const std::string json = json_of(scene, select).dump();
  write_file(path("atlas"), atlas.data(), atlas.size());
  write_file(path("json"), json.data(), json.size());
  write_file(path("floats"), splatlas_floats(), values);
  Json picks = Json::array();
  for (std::uint32_t pick = 0; pick < kPicks; ++pick) {  // around the middle
    const double x = scene.options.size.width * (0.4 + 0.2 * (pick % 2));
    const double y = scene.options.size.height * (0.4 + 0.2 * (pick / 2));
    require(splatlas_pick(x, y));
    picks.push_back({{"at", {x, y}}, {"answer", Json::parse(text())}});
  }
  const std::string answers = picks.dump();
  write_file(path("picks"), answers.data(), answers.size());
}

/// The phantom with scenes, and markup in every text that a page shows.
AtlasContent lesson_content() {
  AtlasContent content = phantom_content();
  std::vector<Structure> structures;
  for (StructureIndex s = 0; s < content.graph.size(); ++s) structures.push_back(content.graph[s]);
  structures[0].name = "<img src=x onerror=alert(1)>";
  structures[1].name = "</script><script>alert(2)</script>";
  structures[2].terms = {{"synonym", "<b>Ball</b>"}};
  content.graph = value_or_throw(StructureGraph::build(std::move(structures)));
  content.provenance.title = "</title><script>alert(3)</script> & \"{{atlas}}\"";
  content.provenance.citation = "<iframe src='javascript:alert(4)'>";
  content.scenes = {{"Both <i>balls</i>", "\"><svg onload=alert(5)> {{script}}", "*:surface", 20, 30, 1},
                    {"Second", "One is faint.", "Sphere_1:surface + Sphere_2:surface(opacity=0.5)", 90, 0, 1},
                    {"Third", "The <b>first</b> one.", "*:volume", 0, 90, 2, "Which <b>ball</b> is it?",
                     "anterior=-15 0.5,0,0.5,20", "Sphere_2"}};
  return content;
}

void write_scenes(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (std::uint32_t n = 0, number = 0; n < kScenes; ++number) {
    RandomScene scene = number % 2 == 0 ? random_scene(number) : cut_scene(1, number);
    if (is_for_module(scene)) write_scene(scene, n++, folder);
  }
  const Bytes phantom = value_or_throw(encode_atlas(phantom_content()));
  write_file(folder / "phantom.atlas", phantom.data(), phantom.size());
  const Bytes lesson = value_or_throw(encode_atlas(lesson_content()));
  write_file(folder / "lesson.atlas", lesson.data(), lesson.size());
}

/// hostile/N.atlas: wrong contents with right checksums, as an attacker writes them. N.floats: the native
/// picture, if one can be drawn whole.
void write_hostile(const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  Random random(6);
  const auto mutate_bytes = [&](Bytes& bytes, std::size_t) {
    for (int n = 0; n < 3 && !bytes.empty(); ++n)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random() % 256);
  };
  for (std::uint32_t n = 0; n < kHostile; ++n) {
    Bytes atlas;
    for (std::uint32_t mutations = 0; mutations < 2 + n % 3; ++mutations)
      atlas = mutate_atlas(std::move(atlas), std::size_t{1} << 16, random, mutate_bytes);
    write_file(folder / fmt::format("{}.atlas", n), atlas.data(), atlas.size());
    give(atlas.data(), atlas.size());
    if (splatlas_open() != 0) continue;
    const std::string select = "*:both";
    give(select.data(), select.size());
    if (splatlas_select() != 0) continue;
    splatlas_camera(20, 10, 1, 0, 0, 0, 0, 0, 30);
    splatlas_clear_cuts();
    require(splatlas_options(0, 0, 1, 0));
    if (splatlas_render(32, 32, 1) != 0 || !text().starts_with("[]")) continue;
    write_file(folder / fmt::format("{}.floats", n), splatlas_floats(), 4 * 32 * 32);
  }
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  splatlas::write_scenes(argv[1]);
  splatlas::write_hostile(std::filesystem::path(argv[1]) / "hostile");
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "splatlas-web-scenes: %s\n", error.what());
  return 1;
}
