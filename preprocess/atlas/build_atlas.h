// Build pipeline from source files to an atlas file.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "format/atlas_reader.h"
#include "format/io/output_file.h"
#include "preprocess/atlas/build_progress.h"
#include "preprocess/atlas/segment_structures.h"
#include "preprocess/classify/classify_voxels.h"
#include "preprocess/import/notes.h"
#include "preprocess/sources/import_sources.h"

namespace splatlas {

/// Inputs and options of a build.
struct BuildOptions {
  SourceFiles sources;
  std::filesystem::path output;
  std::string title, citation, licence;  ///< stored unchanged
  std::string tool;                      ///< name and version of the program, for provenance
  int level = 12;                        ///< Zstandard level, 1 (fast) to 22 (small)
  bool compact = false;                  ///< see WriteOptions
  std::vector<FragmentRule> fragments;   ///< at most one rule per name; the last one holds
  SurfaceRule surfaces = SurfaceRule::kSmooth;
  unsigned threads = 0;       ///< 0: one per core. The file does not depend on it.
  bool strict = false;        ///< fails at the first kind of warnings, before anything is written
  ProgressFunction progress;  ///< may be empty
};

/// Statistics of a finished build.
struct BuildReport {
  std::size_t structures = 0, classes = 0;
  std::array<std::uint64_t, 3> runs{};  ///< of the run models of x, y, z
  std::uint64_t triangles = 0;
  std::uint64_t bytes = 0;  ///< of the file
  std::vector<StageClock::Stage> stages;
  Notes notes;
};

/// Builds an atlas. Refuses an output that is an input or cannot be written before reading any input. On
/// errors the old output file is unchanged. `notes` receives the notes also of a build that fails.
/// `add_files` adds files that are named together with the atlas, once it is encoded and all notes are there.
[[nodiscard]] Result<BuildReport> build_atlas(
    const BuildOptions& options, Notes& notes,
    const std::function<Result<void>(const Atlas&, std::vector<OutputFile>& files)>& add_files = {});
/// The same, with the notes in the report only.
[[nodiscard]] Result<BuildReport> build_atlas(const BuildOptions& options);

/// The default window and bounding sphere. The window is the 1st to the 99.5th percentile of finite grey
/// values in labelled structures, or in all structures if none has a label. Large volumes are subsampled
/// regularly. The sphere is centred on the bounding box of all structures' voxels and contains their corners;
/// without such voxels it is that of the grid. `values` is in the storage grid and may be empty.
[[nodiscard]] Display measure_display(const ClassifiedVoxels& classification, const StructureGraph& graph,
                                      const VoxelBuffer& values, const Grid& storage_grid);

}  // namespace splatlas
