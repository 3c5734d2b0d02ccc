// Scenes of a lesson, from a TOML file.
#pragma once

#include <filesystem>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/result.h"

namespace splatlas {

/// The scenes of a file, in its order.
struct SceneFile {
  std::filesystem::path path;
  std::vector<Scene> scenes;
};

/// Reads a TOML file (toml.io) of at most 16 MiB: a table [[scene]] for each scene, with its name, select,
/// caption, azimuth, elevation (degrees) and zoom; the last four may be left out. kFailed with file, line and
/// remedy for other keys, wrong types and values, and names that repeat.
[[nodiscard]] Result<SceneFile> read_scenes(const std::filesystem::path& path);

/// kFailed, with file and scene, for a selection that the structures do not have.
[[nodiscard]] Result<void> check_selections(const SceneFile& file, const StructureGraph& graph);

}  // namespace splatlas
