#include "preprocess/import/images/pictures/brainglobe_folder.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Direction in LPS of an axis that begins at a side.
std::optional<Vec3> direction_from(char side) {
  switch (side) {
    case 'r': return Vec3{1, 0, 0};
    case 'l': return Vec3{-1, 0, 0};
    case 'a': return Vec3{0, 1, 0};
    case 'p': return Vec3{0, -1, 0};
    case 'i': return Vec3{0, 0, 1};
    case 's': return Vec3{0, 0, -1};
    default: return std::nullopt;
  }
}

}  // namespace

bool is_brainglobe_folder(const fs::path& path) {
  std::error_code error;
  return std::ranges::all_of(std::array{"metadata.json", "annotation.tiff", "structures.json"},
                             [&](const char* name) { return fs::is_regular_file(path / name, error); });
}

Result<std::optional<PictureFrame>> brainglobe_frame(const fs::path& picture) {
  const fs::path folder = picture.has_parent_path() ? picture.parent_path() : fs::path(".");
  if (!is_brainglobe_folder(folder)) return std::nullopt;
  const fs::path file = folder / "metadata.json";
  std::ifstream stream(file);
  const nlohmann::json metadata = nlohmann::json::parse(stream, nullptr, /*allow_exceptions=*/false);
  const auto refuse = [&] {
    return bad_file(
        file, "must have \"resolution\", three numbers in micrometres, and \"orientation\", as \"asr\"");
  };
  if (!metadata.is_object() || !metadata.contains("resolution") || !metadata.contains("orientation"))
    return refuse();
  const nlohmann::json &resolution = metadata["resolution"], &orientation = metadata["orientation"];
  if (!resolution.is_array() || resolution.size() != 3 || !orientation.is_string()) return refuse();
  const auto letters = orientation.get<std::string>();
  if (letters.size() != 3) return refuse();
  PictureFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) {  // of the file: pages, rows, columns
    const std::size_t a = 2 - axis;
    const auto direction = direction_from(letters[axis]);
    if (!direction || !resolution[axis].is_number()) return refuse();
    frame.spacing_mm[a] = resolution[axis].get<double>() / 1000;
    for (std::size_t row = 0; row < 3; ++row) frame.direction_lps[3 * row + a] = (*direction)[row];
  }
  if (!(std::abs(determinant(frame.direction_lps)) > 0)) return refuse();
  return frame;
}

}  // namespace splatlas
