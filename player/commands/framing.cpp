#include "player/commands/framing.h"

#include <cstddef>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/program/command_options.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "player/camera_moves.h"

namespace splatlas {
namespace {

/// Parses three numbers, which need not be valid coordinates.
std::optional<Vec3> parse_numbers(std::string_view text) {
  Vec3 numbers{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t end = a < 2 ? text.find(',') : text.size();
    const auto number = parse_number<double>(text.substr(0, end));
    if (!number || end == std::string_view::npos) return std::nullopt;
    numbers[a] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

std::optional<FrameCenter> parse_center(std::string_view text) {
  if (const auto point = parse_numbers(text)) {
    return is_within_reach(*point) ? std::optional<FrameCenter>(*point) : std::nullopt;
  }
  constexpr std::string_view kPointCharacters = "0123456789+-.,eE ";
  const bool is_point = text.find(',') != std::string_view::npos &&
                        text.find_first_not_of(kPointCharacters) == std::string_view::npos;
  if (text.empty() || is_point) return std::nullopt;
  return FrameCenter(std::string(text));
}

/// Centre of the bounding box of the named structures' voxels.
Result<Vec3> center_of(const std::string& name, const Atlas& atlas) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> named, atlas.graph().find_named(name));
  Selection selection{std::vector<StructureDraw>(atlas.graph().size())};
  for (const StructureIndex s : atlas.graph().descendants(named)) {
    selection.structures[s].mode = DrawMode::kVolume;
  }
  const auto box = bounding_box(atlas, selection);
  if (!box) return fail(ErrorCode::kFailed, "{} has no voxels; name another structure", in_quotes(name));
  Vec3 center{};
  for (std::size_t a = 0; a < 3; ++a) center[a] = 0.5 * (box->first[a] + box->last[a]);
  return center;
}

}  // namespace

CLI::Option* add_view(CLI::App& command, Camera& camera, const std::string& help) {
  return add_choice(command, "--view", camera,
                    {{"anterior", Camera::of(NamedView::kAnterior)},
                     {"posterior", Camera::of(NamedView::kPosterior)},
                     {"left", Camera::of(NamedView::kLeft)},
                     {"right", Camera::of(NamedView::kRight)},
                     {"superior", Camera::of(NamedView::kSuperior)},
                     {"inferior", Camera::of(NamedView::kInferior)}},
                    help);
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

Result<std::optional<Vec3>> center_of(const FrameCenter& center, const Atlas& atlas) {
  if (const auto* point = std::get_if<Vec3>(&center)) return std::optional(*point);
  const auto* name = std::get_if<std::string>(&center);
  if (name == nullptr) return std::nullopt;
  const Result<Vec3> named = center_of(*name, atlas);
  if (!named) return fail(named.error().code, "{}: --center: {}", atlas.name(), named.error().message);
  return std::optional(*named);
}

}  // namespace splatlas
