// What a selection costs in the player, in comparison to full traversal (paper, tables 2 and 4).
#pragma once

#include <array>
#include <memory>
#include <string>

#include "bench/full_traversal.h"
#include "bench/gallery.h"
#include "bench/measure.h"
#include "bench/table.h"
#include "player/render_frame.h"

namespace splatlas {

/// The ways to draw a frame that are compared.
enum class Way : std::uint8_t {
  kFullTraversal,  ///< every voxel and triangle, every frame
  kNewSelection,   ///< the player's first frame of a selection: runs merged, spans built
  kTurning,        ///< the player's later frames of it
};
inline constexpr std::array kWays{Way::kFullTraversal, Way::kNewSelection, Way::kTurning};
[[nodiscard]] const char* name_of(Way way);

enum class Stage : std::uint8_t { kTraversal, kRasterize, kSheets, kResolve, kFrame };
inline constexpr std::size_t kStages = 5;  ///< kFrame is the others' sum

/// One selection with one number of threads.
struct TraversalCost {
  std::array<std::array<Elapsed, kStages>, kWays.size()> medians;  ///< [way][stage], over frames and repeats
  /// Cost of a way in full traversals: the median over frames of the ratio of the medians over repeats.
  std::array<Elapsed, kWays.size()> ratios;
  RenderStats stats;              ///< counts of the last frame
  std::uint64_t bits_differ = 0;  ///< numbers of all pictures in which the player and full traversal differ

  [[nodiscard]] const Elapsed& of(Way way, Stage stage) const {
    return medians[static_cast<std::size_t>(way)][static_cast<std::size_t>(stage)];
  }
  [[nodiscard]] const Elapsed& ratio(Way way) const { return ratios[static_cast<std::size_t>(way)]; }
};

struct TraversalEffort {
  int frames = 7;   ///< turned by 15 degrees each
  int repeats = 3;  ///< of every frame; each turned a degree further, so that no view is drawn twice
};

/// Measures a figure of the gallery at 512x512, the three ways interleaved. Data are decoded beforehand, for
/// the player too. `model` is the atlas's. Compares every picture with every other way's.
[[nodiscard]] Result<TraversalCost> measure_traversal(std::shared_ptr<const Atlas> atlas,
                                                      const VoxelModel& model, const Figure& figure,
                                                      unsigned threads, const TraversalEffort& effort);

/// "figure", "threads", "way", and wall and CPU milliseconds of every stage: one row per way.
void append_stage_rows(const std::string& figure, unsigned threads, const TraversalCost& cost, Table& table);

}  // namespace splatlas
