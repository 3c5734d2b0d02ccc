// Cost of a selection in the player, relative to full traversal (paper, tables 2 and 4).
#pragma once

#include <array>
#include <memory>
#include <string>

#include "bench/full_traversal.h"
#include "bench/gallery.h"
#include "bench/measure.h"
#include "bench/report.h"
#include "player/render_frame.h"

namespace splatlas {

/// Methods to draw a frame.
enum class Method : std::uint8_t {
  kFullTraversal,  ///< all voxels and triangles in every frame
  kNewSelection,   ///< first frame of a selection in the player: merges runs, builds spans
  kTurning,        ///< its later frames
};
inline constexpr std::array kMethods{Method::kFullTraversal, Method::kNewSelection, Method::kTurning};
[[nodiscard]] const char* name_of(Method method);

enum class Stage : std::uint8_t { kTraversal, kRasterize, kSheets, kResolve, kFrame };
inline constexpr std::size_t kStages = 5;  ///< kFrame is the sum of the others

/// One selection with one number of threads.
struct TraversalCost {
  std::array<std::array<Elapsed, kStages>, kMethods.size()>
      medians;  ///< [method][stage], over frames and repeats
  /// Cost of a method relative to full traversal: median over frames of the ratio of medians over repeats.
  std::array<Elapsed, kMethods.size()> ratios;
  RenderStats stats;              ///< counts of the last frame
  std::uint64_t bits_differ = 0;  ///< differing values of all pictures, player against full traversal

  [[nodiscard]] const Elapsed& of(Method method, Stage stage) const {
    return medians[static_cast<std::size_t>(method)][static_cast<std::size_t>(stage)];
  }
  [[nodiscard]] const Elapsed& ratio(Method method) const { return ratios[static_cast<std::size_t>(method)]; }
};

struct TraversalEffort {
  int frames = 7;   ///< 15 degrees apart
  int repeats = 3;  ///< per frame; each turned by a further degree, so that no view repeats
};

/// Measures a figure of the gallery at 512x512, with the three methods interleaved. All data are decoded in
/// advance, for the player too. `model` belongs to the atlas. Compares the pictures of all methods.
[[nodiscard]] Result<TraversalCost> measure_traversal(std::shared_ptr<const Atlas> atlas,
                                                      const VoxelModel& model, const Figure& figure,
                                                      unsigned threads, const TraversalEffort& effort);

/// "figure", "threads", "method", and wall and CPU milliseconds of every stage: one row per method.
void append_stage_rows(const std::string& figure, unsigned threads, const TraversalCost& cost, Table& table);

}  // namespace splatlas
