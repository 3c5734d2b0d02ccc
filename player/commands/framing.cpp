#include "player/commands/framing.h"

#include <cstddef>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/program/command_options.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {
CLI::Option* add_view(CLI::App& command, Camera& camera, const std::string& help) {
  Choices<Camera> views;
  for (std::size_t n = 0; n < kViewAngles.size(); ++n)
    views.emplace_back(kViewAngles[n].name, Camera::of(static_cast<NamedView>(n)));
  return add_choice(command, "--view", camera, views, help);
}

void add_framing(CLI::App& command, bool& fits_selection, FrameCenter& center) {
  add_choice(command, "--fit", fits_selection, {{"selection", true}, {"grid", false}},
             "content of the picture at zoom 1: the selected voxels and surfaces, or the whole atlas");
  add_parsed(command, "--center", center, parse_center,
             fmt::format("must be X,Y,Z in LPS mm, each at most {} from 0, or name a structure", kMaxMm),
             "middle of the picture: a structure (see NAME), or X,Y,Z in LPS mm; the zoom stays");
}

Result<Scene> find_scene(const std::string& name, const Atlas& atlas) {
  constexpr std::size_t kMaxNames = 20;
  std::string names;
  for (const Scene& scene : atlas.scenes()) {
    if (equal_ignoring_case(scene.name, name)) return scene;
    if (&scene - atlas.scenes().data() < static_cast<std::ptrdiff_t>(kMaxNames))
      names += (names.empty() ? "" : ", ") + in_quotes(scene.name);
  }
  if (atlas.scenes().size() > kMaxNames) names += ", ...";
  return fail(ErrorCode::kNotFound, "{}: --scene {}: the atlas has {}", atlas.name(), in_quotes(name),
              names.empty() ? "no scenes; build it with --scene FILE.toml" : "the scenes " + names);
}

Error in_selection(const Error& error, const Atlas& atlas, const std::string& scene) {
  if (scene.empty()) return {error.code, fmt::format("{}: {}", atlas.name(), error.message), {}};
  return {ErrorCode::kInvalidAtlas,
          fmt::format("{}: scene {}: {}", atlas.name(), in_quotes(scene), error.message),
          {}};
}

}  // namespace splatlas
