#include "bench/scenes/gallery.h"

#include <fstream>
#include <optional>
#include <sstream>

#include <fmt/format.h>

namespace splatlas {
namespace {

/// Camera options such as "--azimuth 30 --elevation 20 --zoom 2". Skips cuts and their faces, which are not
/// measured.
std::optional<Camera> parse_camera(const std::string& text) {
  Camera camera;
  std::istringstream words(text);
  std::string option;
  while (words >> option) {
    double* const value = option == "--azimuth"     ? &camera.azimuth_deg
                          : option == "--elevation" ? &camera.elevation_deg
                          : option == "--zoom"      ? &camera.zoom
                                                    : nullptr;
    if (std::string skipped; option == "--cut" || option == "--cap") {
      if (!(words >> skipped)) return std::nullopt;
      continue;
    }
    if (value == nullptr || !(words >> *value)) return std::nullopt;
  }
  return camera;
}

/// Name, atlas, view and selection, separated by tabs.
std::optional<Figure> parse_figure(const std::string& line) {
  std::istringstream columns(line);
  Figure figure;
  std::string view;
  if (!std::getline(columns, figure.name, '\t') || !std::getline(columns, figure.atlas, '\t') ||
      !std::getline(columns, view, '\t') || !std::getline(columns, figure.selection)) {
    return std::nullopt;
  }
  const std::optional<Camera> camera = parse_camera(view);
  if (!camera) return std::nullopt;
  figure.camera = *camera;
  return figure;
}

}  // namespace

Result<std::vector<Figure>> read_gallery(const std::filesystem::path& path, const std::string& atlas) {
  std::ifstream file(path);
  if (!file) return fail(ErrorCode::kFailed, fmt::format("{}: cannot be read", path.string()));
  std::vector<Figure> figures;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line.starts_with('#')) continue;
    const std::optional<Figure> figure = parse_figure(line);
    if (!figure) {
      return fail(
          ErrorCode::kFailed,
          fmt::format("{}: line {}: must be NAME, ATLAS, VIEW and SELECTION, separated by tabs, the view "
                      "of --azimuth, --elevation and --zoom",
                      path.string(), number));
    }
    if (figure->atlas == atlas) figures.push_back(*figure);
  }
  if (figures.empty()) {
    return fail(ErrorCode::kFailed, fmt::format("{}: has no figure of {}", path.string(), atlas));
  }
  return figures;
}

Result<std::vector<Figure>> read_gallery(const std::string& atlas) {
  return read_gallery(std::filesystem::path(SPLATLAS_SOURCE_DIR) / "scripts/gallery.tsv", atlas);
}

}  // namespace splatlas
