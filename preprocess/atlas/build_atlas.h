// Build pipeline from source files to an atlas file, with its progress, segments and fragments.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "format/atlas_reader.h"
#include "format/io/output_file.h"
#include "preprocess/classify/classify_voxels.h"
#include "preprocess/import/notes.h"
#include "preprocess/sources/import_sources.h"
#include "preprocess/structures/build_graph.h"

namespace splatlas {

/// Progress report: sent at the beginning of a stage (fraction 0), at intervals, and once at its end.
struct BuildProgress {
  std::string stage;          ///< "read", "segment", "classify", "surfaces", "write"
  double stage_fraction = 0;  ///< of this stage, 0 to 1
  double total_fraction = 0;  ///< of the whole build, estimated from typical costs of stages
  double stage_seconds = 0;   ///< elapsed in this stage
  double total_seconds = 0;   ///< elapsed in the build
  bool stage_ended = false;
};

using ProgressFunction = std::function<void(const BuildProgress&)>;

/// Measures and reports the stages of a build. Not thread-safe.
class StageClock {
 public:
  /// `listen` may be empty.
  explicit StageClock(ProgressFunction listen) : listen_(std::move(listen)), start_(Clock::now()) {}

  /// Ends the current stage and begins the next. `weight`: its fraction of a typical build, in sum 1.
  void begin(const std::string& stage, double weight) {
    end();
    stage_ = stage;
    weight_ = weight;
    stage_start_ = Clock::now();
    update(0);
  }
  void update(double stage_fraction) { report(stage_fraction, false); }
  void end() {
    if (stage_.empty()) return;
    report(1, true);
    stages_.push_back({stage_, seconds_since(stage_start_)});
    weight_before_ += weight_;
    stage_.clear();
  }

  struct Stage {
    std::string name;
    double seconds = 0;
  };
  [[nodiscard]] const std::vector<Stage>& stages() const { return stages_; }  ///< finished stages

 private:
  using Clock = std::chrono::steady_clock;
  void report(double stage_fraction, bool ended) const {
    if (!listen_ || stage_.empty()) return;
    listen_({stage_, stage_fraction, std::min(1.0, weight_before_ + weight_ * stage_fraction),
             seconds_since(stage_start_), seconds_since(start_), ended});
  }
  [[nodiscard]] static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  ProgressFunction listen_;
  Clock::time_point start_, stage_start_;
  std::string stage_;
  double weight_ = 0, weight_before_ = 0;
  std::vector<Stage> stages_;
};

/// Rule of one --drop-fragments option.
struct FragmentRule {
  std::string name;         ///< of a label, mask or segment; empty for all others
  std::uint64_t below = 0;  ///< components of fewer voxels are dropped
};

/// Parses N or NAME=N, N from 0 to 2^40; kUsage otherwise.
[[nodiscard]] Result<FragmentRule> parse_fragments(std::string_view text);

/// Drops fragments of labels and masks, then adds the segments in their order. A segment gets only voxels
/// that no structure but isosurfaces contains yet, or all of its mask if its rule overlaps; its opening and
/// its rule of fragments follow. Dropped voxels may get into later segments. An isosurface gets all voxels
/// from its level on, within its enclosing structure and the descendants of it. Adds a note on dropped
/// fragments, and one on those of fewer than 100 voxels of structures without a rule. kUsage for names that
/// are no label, mask or segment, kNotFound for unknown enclosing structures, kLimit for isosurfaces in a
/// grid above kMaxIsosurfaceSize. `progress` receives the fraction done.
[[nodiscard]] Result<void> segment_structures(SourceModel& model, const PlacedStructures& placed,
                                              const Grid& grid, const std::vector<FragmentRule>& rules,
                                              const std::function<void(double)>& progress, Notes& notes);

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
