#include "bench/scenes/cut_rows.h"

#include <array>
#include <vector>

#include <fmt/format.h>

#include "bench/measure/frames.h"
#include "bench/measure/measure.h"
#include "format/result_macros.h"
#include "player/renderer.h"

namespace splatlas {
namespace {

struct CutScene {
  const char* name;
  const char* selection;
  Classification classification;
};
constexpr std::array kCutScenes{CutScene{"sheets", "Head", Classification::kBefore},
                                CutScene{"rays", "Head", Classification::kAfter},
                                CutScene{"surfaces", "Head:surface", Classification::kBefore}};

/// Each removes about half of the head: the part that faces most views, and half of the picture.
struct HalfCut {
  const char* removed;
  CutPlane plane;
};
constexpr std::array kHalfCuts{HalfCut{"left", {{1, 0, 0}, 0}}, HalfCut{"superior", {{0, 0, 1}, 0}}};

struct Measured {
  Elapsed whole, half;
  double ratio = 0, hollow = 0;
};

/// Times of the whole head, of a half with faces and of a half without, in turned views.
Result<Measured> measure_half(const std::shared_ptr<const Atlas>& atlas, const CutScene& scene,
                              Quality quality, const CutPlane& plane, bool quick) {
  const int frames = quick ? 4 : 7, repeats = quick ? 1 : 3;
  Renderer renderer(atlas, {.threads = 1});
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(scene.selection, atlas->graph()));
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  Frame frame;
  const auto draw = [&](int turn, bool cuts, CapMode caps) -> Result<void> {
    RenderOptions render{.size = {512, 512}, .quality = quality};
    render.classification = scene.classification;
    render.caps = caps;
    if (cuts) SPLATLAS_RETURN_IF_ERROR(render.cuts.add(plane));
    return renderer.render(turned(oblique_camera(), turn, frames), render, frame);
  };
  std::vector<Contender> contenders;
  contenders.push_back(timed([&](int turn) { return draw(turn, false, CapMode::kBoth); }));
  contenders.push_back(timed([&](int turn) { return draw(turn, true, CapMode::kBoth); }));
  contenders.push_back(timed([&](int turn) { return draw(turn + frames * repeats, true, CapMode::kNone); }));
  for (int turn = 0; turn < frames; ++turn) {  // decode, build and map everything
    for (const bool cuts : {false, true}) SPLATLAS_RETURN_IF_ERROR(draw(turn, cuts, CapMode::kBoth));
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, frames * repeats));
  return Measured{median(times[0][0]), median(times[1][0]),
                  median_ratio(times[1][0], times[0][0], frames).cpu_ms,
                  median_ratio(times[2][0], times[0][0], frames).cpu_ms};
}

}  // namespace

Result<void> add_cut_table(const std::shared_ptr<const Atlas>& atlas, const BenchOptions& options,
                           Report& report) {
  Table table{"cut",
              "Half of the head, with faces, 512x512, 1 thread, default shading",
              {"ratio: CPU time over that of the whole head, median over frames; hollow: without faces",
               "early ray termination hides most of a whole head: a cut towards the viewer saves less"}};
  for (const CutScene& scene : kCutScenes) {
    for (const NamedQuality& quality : kQualities) {
      if (quality.quality == Quality::kHigh) continue;
      for (const HalfCut& cut : kHalfCuts) {
        SPLATLAS_ASSIGN_OR_RETURN(const Measured measured,
                                  measure_half(atlas, scene, quality.quality, cut.plane, options.quick));
        table.rows.push_back({{"scene", scene.name},
                              {"quality", quality.name},
                              {"removed", cut.removed},
                              {"whole_cpu", measured.whole.cpu_ms},
                              {"half_cpu", measured.half.cpu_ms},
                              {"ratio", measured.ratio},
                              {"hollow", measured.hollow}});
        if (&scene == kCutScenes.data())
          report.summary[fmt::format("cut_{}_{}", cut.removed, quality.name)] = measured.ratio;
      }
    }
  }
  report.tables.push_back(std::move(table));
  return {};
}

}  // namespace splatlas
