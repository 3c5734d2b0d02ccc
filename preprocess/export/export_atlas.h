// The way back: what an atlas was made from.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "format/result.h"

namespace splatlas {

struct ExportOptions {
  std::filesystem::path atlas;
  std::string labels;            ///< a volume file; a folder for one mask per structure when it ends in "/"
  std::filesystem::path volume;  ///< a volume file
  /// Structures (names, ids, paths or patterns; a group stands for what is below it) and mesh files.
  std::vector<std::pair<std::string, std::filesystem::path>> surfaces;
};

struct ExportedFiles {
  std::vector<std::string> written;  ///< one line per file
  /// One per file that could not be made for damage of the atlas, or the one that ended the export.
  std::vector<Error> failures;
};

/// Writes what is asked for; empty paths are not. Volumes have the grid, order of axes and pixel type of the
/// source. Before anything is read: kUsage for endings of unknown types and when an output is the atlas or
/// another output (by whatever path), kFailed for outputs that cannot be written. Before anything is written:
/// kNotFound for unknown structures, kFailed when the atlas holds no grey values, no labels or no surface.
/// Each file is written whole or not at all; damage of the atlas costs the files that need what is
/// damaged, and no others.
[[nodiscard]] Result<ExportedFiles> export_atlas(const ExportOptions& options);

}  // namespace splatlas
