#include "bench/measure/frames.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <set>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "player/render/view/shear.h"

namespace splatlas {

Camera oblique_camera() {
  return {.azimuth_deg = 30, .elevation_deg = 20};
}

Camera turned(Camera camera, int turn, int frames) {
  constexpr double kTurnDeg = 15;
  constexpr double kRepeatTurnDeg = 1;
  const int frame = turn % frames;
  const int repeat = turn / frames;
  camera.azimuth_deg += kTurnDeg * frame + kRepeatTurnDeg * repeat;
  return camera;
}

Result<std::vector<Camera>> cameras_by_axis(const Camera& camera, int turns, int frames, const Atlas& atlas) {
  std::vector<Camera> cameras;
  std::set<Axis> axes;
  for (int turn = 0; turn < turns; ++turn) {
    const Camera at = turned(camera, turn, frames);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(at, {64, 64}, atlas.display()));
    if (axes.insert(factorise(view, atlas.grid()).principal).second) cameras.push_back(at);
  }
  return cameras;
}

Result<RenderStats> draw_frame(FrameScene scene, const SpanModel& spans, const Shear& shear,
                               FrameBuffers& buffers, Picture& picture, ThreadPool& pool) {
  scene.max_memory_bytes = std::numeric_limits<std::uint64_t>::max();
  RenderStats stats;
  const SheetVolume volume{SheetSpans(spans), shear, scene.grid, {}};
  SheetFrame frame(scene, volume, buffers, stats, pool);
  TaskControl task({}, {});
  SPLATLAS_RETURN_IF_ERROR(frame.run(1, task, picture));
  return stats;
}

std::uint64_t bits_differ(std::span<const float> a, std::span<const float> b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size());
  std::uint64_t differ = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    differ += std::bit_cast<std::uint32_t>(a[n]) != std::bit_cast<std::uint32_t>(b[n]) ? 1 : 0;
  }
  return differ;
}

}  // namespace splatlas
