// The whole way from files to an atlas file.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "preprocess/build_progress.h"
#include "preprocess/import_sources.h"

namespace splatlas {

struct BuildOptions {
  SourceFiles sources;
  std::filesystem::path output;
  std::string title, citation, licence;  ///< kept as given
  std::string tool;                      ///< name and version of the program, for provenance
  int level = 12;                        ///< Zstandard's, 1 (fast) to 22 (small)
  bool compact = false;                  ///< see WriteOptions
  unsigned threads = 0;                  ///< 0: all cores. The file does not depend on it.
  ProgressFunction progress;             ///< may be empty
};

struct BuildReport {
  std::size_t structures = 0, classes = 0;
  std::array<std::uint64_t, 3> runs{};  ///< of the models of x, y, z
  std::uint64_t triangles = 0;
  std::uint64_t bytes = 0;  ///< of the file
  std::vector<StageClock::Stage> stages;
  std::vector<std::string> notes;  ///< oddities that are no errors, one line each
};

/// Builds an atlas. Refuses an output that is one of the inputs or cannot be a file, before anything is read.
/// On any error the output is what it was.
[[nodiscard]] Result<BuildReport> build_atlas(const BuildOptions& options);

}  // namespace splatlas
