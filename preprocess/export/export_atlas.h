// Export of labels, volumes and surfaces from an atlas.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/result.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Atlas and outputs of an export. Empty paths are not written.
struct ExportOptions {
  std::filesystem::path atlas;
  std::string labels;  ///< a volume file, "-" for an NRRD stream, or a folder of masks if it ends in "/"
  std::filesystem::path volume;  ///< a volume file
  /// Structures (names, ids, paths or patterns; with descendants) and their mesh files.
  std::vector<std::pair<std::string, std::filesystem::path>> surfaces;
  std::filesystem::path names;  ///< a table of names
  NamesFormat names_format = NamesFormat::kCsv;
  std::filesystem::path tree;  ///< a tree file
  AtlasOptions atlas_options = {};

  [[nodiscard]] bool streams_labels() const { return labels == "-"; }
};

struct ExportedFiles {
  std::vector<std::string> written;  ///< one line per file
  std::vector<std::string> notes;    ///< one line each
  std::vector<std::byte> stream;     ///< labels for standard output
  /// One error per file that could not be written because of damage, or the error that ended the export.
  std::vector<Error> failures;
  std::vector<std::string> damaged;  ///< files that were not written because of damage
};

/// Exports files. Volumes have the grid, axis order and pixel type of the source. Before reading: kUsage for
/// unknown file types and for outputs that are the atlas or another output; kFailed for outputs that cannot
/// be written. Before writing: kNotFound for unknown structures; kFailed for an atlas without the requested
/// grey values, labels or surface. Names files only once all are written: after another failure than damage
/// there is none. Damage affects only the files that need the damaged data.
[[nodiscard]] Result<ExportedFiles> export_atlas(const ExportOptions& options);

}  // namespace splatlas
