// splatlas-web-scenes FOLDER: draws random scenes by a page's engine and by the renderer, which must agree to
// the bit, and writes each for the module's test: N.atlas, N.json, N.floats, the picture, and N.picks. Also
// phantom.atlas, lesson.atlas for a page, and hostile atlases.
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/atlas_writer.h"
#include "player/web/page_engine.h"
#include "player/web/page_json.h"
#include "tests/fuzz/mutators.h"
#include "tests/support/phantom_content.h"
#include "tests/support/random_scene.h"
#include "tests/support/selection_text.h"

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

/// Calls the engine. Throws its message.
std::string ask(PageEngine& engine, Json request, const char* call, Bytes bytes = {}) {
  request["call"] = call;
  PageAnswer answer = engine.call(request.dump(), std::move(bytes));
  if (answer.status != 0) throw std::runtime_error(answer.text);
  return std::move(answer.text);
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

/// The scene as a state of page_state_of().
Json state_of(const RandomScene& scene, const std::string& select) {
  const RenderOptions& options = scene.options;
  Json cuts = Json::array();
  for (const CutPlane& cut : options.cuts)
    cuts.push_back({{"normal", cut.normal_lps}, {"offset", cut.offset_mm}});
  constexpr std::array kCaps{"values", "labels", "both", "none"};
  constexpr std::array kQualities{"draft", "normal", "high"};
  return {{"select", select},
          {"camera", json_of(scene.camera)},
          {"cuts", cuts},
          {"caps", kCaps[static_cast<std::size_t>(options.caps)]},
          {"depthCue", options.depth_cue == DepthCue::kEdges},
          {"shading", options.hybrid_shading},
          {"quality", kQualities[static_cast<std::size_t>(options.quality)]},
          {"size", {options.size.width, options.size.height}}};
}

/// Draws and writes the n-th scene.
void write_scene(RandomScene& scene, std::uint32_t n, const std::filesystem::path& folder) {
  const Bytes atlas = value_or_throw(encode_atlas(scene.content));
  const std::string select = text_of(scene.selection, scene.content.graph);
  const Json state = state_of(scene, select);
  PageEngine engine({.threads = 1});
  ask(engine, {}, "open", atlas);
  ask(engine, state, "draw");

  Renderer renderer(value_or_throw(Atlas::open_bytes(atlas)), {.threads = 1});
  value_or_throw(renderer.select(value_or_throw(Selection::parse(select, scene.content.graph))));
  const Frame frame = value_or_throw(renderer.render(scene.camera, scene.options));
  if (frame.picture.rgba != engine.frame().picture.rgba)
    throw std::runtime_error(fmt::format("scene {}: the engine draws another picture than the renderer", n));

  const auto path = [&](const char* ending) { return folder / fmt::format("{}.{}", n, ending); };
  const std::string json = state.dump();
  write_file(path("atlas"), atlas.data(), atlas.size());
  write_file(path("json"), json.data(), json.size());
  write_file(path("floats"), frame.picture.rgba.data(), frame.picture.rgba.size());
  Json picks = Json::array();
  for (std::uint32_t pick = 0; pick < kPicks; ++pick) {  // around the middle
    const double x = scene.options.size.width * (0.4 + 0.2 * (pick % 2));
    const double y = scene.options.size.height * (0.4 + 0.2 * (pick / 2));
    const Json at{{"at", {x, y}}};
    picks.push_back({{"at", {x, y}}, {"answer", Json::parse(ask(engine, at, "pick"))}});
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

/// hostile/N.atlas: wrong contents with right checksums. N.floats: the native picture, if it is whole.
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
    PageEngine engine({.threads = 1});
    if (engine.call(R"({"call": "open"})", atlas).status != 0) continue;
    const PageAnswer drawn = engine.call(
        R"({"call": "draw", "select": "*:both", "size": [32, 32], "caps": "values", "camera": {"azimuth": 20, "elevation": 10}})");
    if (drawn.status != 0 || !Json::parse(drawn.text).at("missing").empty()) continue;
    write_file(folder / fmt::format("{}.floats", n), engine.frame().picture.rgba.data(),
               engine.frame().picture.rgba.size());
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
