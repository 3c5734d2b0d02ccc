#include "bench/error_cost.h"

#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "bench/measure.h"
#include "bench/peers/volpack_peer.h"
#include "player/render_frame.h"
#include "player/shear.h"
#include "tests/reference/grey_truth.h"

namespace splatlas {
namespace {

using reference::GreyTruth;
using reference::PictureDifference;
using reference::ReferencePicture;

struct Setting {
  const char* name;
  Quality quality;
};
constexpr std::array kSettings{Setting{"draft", Quality::kDraft}, Setting{"normal", Quality::kNormal},
                               Setting{"high", Quality::kHigh}};

/// A renderer that takes part: what it is called, and how it draws.
struct Participant {
  RendererCost cost;
  std::function<Result<void>(const Camera& camera)> draw;
  std::function<Picture()> picture;
};

/// Sums up differences of several views.
class ErrorSum {
 public:
  void add(const PictureDifference& d) {
    squares_ += d.rms * d.rms;
    sum_.mean += d.mean;
    if (d.largest > sum_.largest) {
      sum_.largest = d.largest;
      sum_.column = d.column;
      sum_.row = d.row;
    }
    sum_.pixels += d.pixels;
    ++views_;
  }
  [[nodiscard]] PictureDifference mean() const {
    PictureDifference mean = sum_;
    mean.rms = std::sqrt(squares_ / views_);
    mean.mean /= views_;
    return mean;
  }

 private:
  double squares_ = 0;
  PictureDifference sum_;
  int views_ = 0;
};

/// One renderer of ours, with its latest picture.
struct Ours {
  Renderer renderer;
  RenderOptions options;
  Picture latest;

  Result<void> draw(const Camera& camera, Quality quality) {
    options.quality = quality;
    SPLATLAS_ASSIGN_OR_RETURN(latest, renderer.render(camera, options));
    return {};
  }
};

/// Selects, and draws once per principal axis and quality, so that all is decoded and merged.
Result<void> prepare(Ours& ours, const ErrorModel& model, const ErrorEffort& effort) {
  SPLATLAS_RETURN_IF_ERROR(ours.renderer.select(model.selection));
  const Atlas& atlas = ours.renderer.atlas();
  std::set<Axis> prepared;
  for (int turn = 0; turn < effort.frames * effort.repeats; ++turn) {
    const Camera camera = turned(model.camera, turn, effort.frames);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view,
                              parallel_view(camera, ours.options.size, atlas.display()));
    if (!prepared.insert(factorise(view, atlas.grid()).principal).second) continue;
    for (const Setting& setting : kSettings) SPLATLAS_RETURN_IF_ERROR(ours.draw(camera, setting.quality));
  }
  return {};
}

Result<void> compare(std::vector<Participant>& participants, const ErrorModel& model, const PictureSize& size,
                     const Display& display, const ErrorEffort& effort) {
  const GreyTruth truth(model.volume, model.look, reference::Classification::kBeforeInterpolation);
  std::vector<ErrorSum> errors(participants.size());
  for (int frame = 0; frame < effort.views_compared; ++frame) {
    const Camera camera = turned(model.camera, 2 * frame, effort.frames);
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, size, display));
    const ReferencePicture expected = render_grey_truth(truth, model.volume.grid, view, 0);
    for (std::size_t n = 0; n < participants.size(); ++n) {
      SPLATLAS_RETURN_IF_ERROR(participants[n].draw(camera));
      errors[n].add(difference(participants[n].picture(), expected));
    }
  }
  for (std::size_t n = 0; n < participants.size(); ++n) participants[n].cost.error = errors[n].mean();
  return {};
}

Result<void> take_times(std::vector<Participant>& participants, const ErrorModel& model,
                        const ErrorEffort& effort) {
  std::vector<Contender> contenders;
  for (const Participant& participant : participants) {
    contenders.emplace_back([&](int turn) -> Result<std::vector<Elapsed>> {
      const Camera camera = turned(model.camera, turn, effort.frames);
      Stopwatch watch;
      SPLATLAS_RETURN_IF_ERROR(participant.draw(camera));
      return std::vector{watch.lap()};
    });
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StageTimes> times,
                            measure_interleaved(contenders, effort.frames * effort.repeats));
  for (std::size_t n = 0; n < participants.size(); ++n) participants[n].cost.frame = median(times[n].front());
  return {};
}

RendererCost named(std::string renderer, std::string setting, unsigned threads) {
  RendererCost cost;
  cost.renderer = std::move(renderer);
  cost.setting = std::move(setting);
  cost.threads = threads;
  return cost;
}

void add_ours(Ours& ours, unsigned threads, std::vector<Participant>& participants) {
  for (const Setting& setting : kSettings) {
    Participant participant;
    participant.cost = named("splatlas", setting.name, threads);
    participant.draw = [&ours, &setting](const Camera& camera) { return ours.draw(camera, setting.quality); };
    participant.picture = [&ours] { return ours.latest; };
    participants.push_back(std::move(participant));
  }
}

Participant of(VolpackPeer& volpack, const char* setting, const PictureSize& size, const Display& display) {
  Participant participant;
  participant.cost = named("VolPack", setting, 1);
  participant.draw = [&volpack, size, &display](const Camera& camera) -> Result<void> {
    SPLATLAS_ASSIGN_OR_RETURN(const ParallelView view, parallel_view(camera, size, display));
    return volpack.render(view);
  };
  participant.picture = [&volpack] { return volpack.picture(); };
  return participant;
}

}  // namespace

Result<std::vector<RendererCost>> measure_parallel(const std::shared_ptr<const Atlas>& atlas,
                                                   const ErrorModel& model, int size,
                                                   const ErrorEffort& effort) {
  RenderOptions options;
  options.size = {size, size};
  options.hybrid_shading = false;
  Ours one{Renderer(atlas, {.threads = 1}), options, {}};
  Ours two{Renderer(atlas, {.threads = 2}), options, {}};
  SPLATLAS_RETURN_IF_ERROR(prepare(one, model, effort));
  SPLATLAS_RETURN_IF_ERROR(prepare(two, model, effort));
  SPLATLAS_ASSIGN_OR_RETURN(VolpackPeer volpack,
                            VolpackPeer::classify(model.volume, model.look, OpacityRounding::kDown));
  SPLATLAS_ASSIGN_OR_RETURN(VolpackPeer rounded,
                            VolpackPeer::classify(model.volume, model.look, OpacityRounding::kNearest));
  std::vector<Participant> participants;
  add_ours(one, 1, participants);
  add_ours(two, 2, participants);
  participants.push_back(of(volpack, "classified", options.size, atlas->display()));
  participants.push_back(of(rounded, "rounded", options.size, atlas->display()));

  SPLATLAS_RETURN_IF_ERROR(compare(participants, model, options.size, atlas->display(), effort));
  SPLATLAS_RETURN_IF_ERROR(take_times(participants, model, effort));
  std::vector<RendererCost> costs;
  for (Participant& participant : participants) costs.push_back(std::move(participant.cost));
  return costs;
}

}  // namespace splatlas
