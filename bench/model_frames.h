// Frames of one selection through every model of an atlas: run model, run models per level, octrees.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "bench/class_octree.h"
#include "bench/level_runs.h"
#include "bench/run_collector.h"
#include "player/frame/sheet_frame.h"
#include "player/frame/stopwatch.h"
#include "player/render_frame.h"
#include "player/spans/class_cache.h"
#include "player/spans/selected_runs.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

/// Models that yield the runs of a selection.
enum class Model : std::uint8_t { kRuns, kLevels, kVoxelOctree, kBrickOctree };
inline constexpr std::array kModels{Model::kRuns, Model::kLevels, Model::kVoxelOctree, Model::kBrickOctree};
[[nodiscard]] const char* name_of(Model model);

/// The atlas in every model, decoded.
struct Models {
  std::shared_ptr<const Atlas> atlas;
  ClassCache classes;  ///< runs of every class along every axis, and values
  LevelRuns levels;
  ClassOctree voxel_octree, brick_octree;

  [[nodiscard]] static Result<Models> make(std::shared_ptr<const Atlas> atlas, ThreadPool& pool);
};

/// The first frame of a selection, unlit; only the retrieval of runs differs. The run model is traversed as
/// in the player; other models return lists of runs. The rest is the code of the player, except for the loop
/// over slices, as SpanBuilder knows no other model. Pictures are compared with those of the player.
class ModelFrames {
 public:
  /// Both must outlive this.
  ModelFrames(const Models& models, ThreadPool& pool);

  [[nodiscard]] Result<void> select(std::string_view selection);

  /// Stages of draw(): retrieval of runs from other models; span build (includes retrieval for the run
  /// model); both; drawing; all.
  enum Stage : std::uint8_t { kFind, kSpans, kTraversal, kDraw, kFrame };
  /// Draws a turn of an oblique view, 512x512, through one model. Every turn must use all models.
  [[nodiscard]] Result<std::vector<Elapsed>> draw(Model model, int turn, int frames);

  /// Of the latest frame: runs (adjacent ones of equal appearance count once), and voxels with extinction.
  [[nodiscard]] std::uint64_t runs() const { return runs_; }
  [[nodiscard]] std::uint64_t voxels() const { return spans_.voxels; }
  /// Number of values whose bits differ from the pictures of the player.
  [[nodiscard]] std::uint64_t bits_differ() const { return bits_differ_; }

 private:
  [[nodiscard]] FoundRuns find(Model model, std::span<const std::uint32_t> draws, Axis axis) const;
  template <typename Walk>
  void build_spans(const SelectedRuns& selected, const Walk& walk);
  template <typename Walk>
  void build_slice(std::int64_t slice, const Walk& walk);
  [[nodiscard]] Result<void> compare(const Camera& camera);

  const Models& models_;
  ThreadPool& pool_;
  VolumeAppearances appearances_;
  RenderOptions options_;
  DrawPlan plan_;
  SpanModel spans_;
  FrameBuffers buffers_;
  Picture picture_;
  Renderer player_;
  Picture players_picture_;
  std::optional<Camera> players_camera_;
  std::uint64_t runs_ = 0, bits_differ_ = 0;
};

}  // namespace splatlas
