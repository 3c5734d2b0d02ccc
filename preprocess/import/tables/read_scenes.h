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

/// Reads a TOML file (toml.io) of at most 16 MiB: a table [[scene]] for each scene, with the keys of
/// docs/guide.md; all but name and select may be left out. A view becomes its azimuth and elevation. kFailed
/// with file, line and remedy for other keys, wrong types and values, and names that repeat.
[[nodiscard]] Result<SceneFile> read_scenes(const std::filesystem::path& path);
/// The same of several files. kFailed also if two of them have scenes of one name.
[[nodiscard]] Result<std::vector<SceneFile>> read_scenes(const std::vector<std::filesystem::path>& paths);

/// The scenes of all files. kFailed, with file and scene, for a selection, centre or label that the
/// structures do not have.
[[nodiscard]] Result<std::vector<Scene>> scenes_of(const std::vector<SceneFile>& files,
                                                   const StructureGraph& graph);

}  // namespace splatlas
