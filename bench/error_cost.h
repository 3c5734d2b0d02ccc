// Time and error of every renderer in one scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/error_scenes.h"
#include "format/atlas_reader.h"
#include "player/stopwatch.h"
#include "tests/reference/picture_difference.h"

namespace splatlas {

/// One renderer at one setting.
struct RendererCost {
  std::string renderer;  ///< "splatlas", "VolPack"
  std::string setting;   ///< quality, or sampling step
  unsigned threads = 1;
  Elapsed frame;  ///< medians over the frames
  reference::PictureDifference
      error;  ///< root mean square, largest and mean over the views that were compared
};

struct ErrorEffort {
  int frames = 7;
  int repeats = 3;
  int views_compared = 2;
};

/// Parallel projection, grey values classified before interpolation: ours at every quality with one and with
/// two threads, and VolPack; frames interleaved. Selected, decoded, classified and merged beforehand. Errors
/// against the truth in double precision, in full scales.
[[nodiscard]] Result<std::vector<RendererCost>> measure_parallel(const std::shared_ptr<const Atlas>& atlas,
                                                                 const ErrorModel& model, int size,
                                                                 const ErrorEffort& effort);

}  // namespace splatlas
