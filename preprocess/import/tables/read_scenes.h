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
/// question, caption, azimuth, elevation (degrees), zoom, center (X,Y,Z in LPS mm, or a structure) and cuts
/// (texts as of --cut); all but the first two may be left out. kFailed with file, line and
/// remedy for other keys, wrong types and values, and names that repeat.
[[nodiscard]] Result<SceneFile> read_scenes(const std::filesystem::path& path);
/// The same of several files. kFailed also if two of them have scenes of one name.
[[nodiscard]] Result<std::vector<SceneFile>> read_scenes(const std::vector<std::filesystem::path>& paths);

/// The scenes of all files. kFailed, with file and scene, for a selection or a centre that the structures do
/// not have.
[[nodiscard]] Result<std::vector<Scene>> scenes_of(const std::vector<SceneFile>& files,
                                                   const StructureGraph& graph);

}  // namespace splatlas
