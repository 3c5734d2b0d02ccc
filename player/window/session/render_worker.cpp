#include "player/window/session/render_worker.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "player/write_png.h"

namespace splatlas {
namespace {

/// Time without requests before a picture is refined.
constexpr std::chrono::milliseconds kStill{120};
/// The renderer chooses the detail of drafts for this time.
constexpr double kDraftBudgetMs = 33;
/// After two slower drafts, the next ones get a lower resolution; after a quicker one, a higher resolution.
constexpr double kSlowDraftMs = 70, kQuickDraftMs = 20;
constexpr int kMaxDraftDivisor = 4;
constexpr Rgb kBackground{0, 0, 0};

/// Converts exceptions of `work`, such as std::bad_alloc, to kLimit.
template <typename Work>
auto guarded(Work work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& exception) {
    return fail(ErrorCode::kLimit, fmt::format("cannot render: {}; select less", exception.what()));
  }
}

}  // namespace

RenderWorker::RenderWorker(std::shared_ptr<const Atlas> atlas, const RendererOptions& options,
                           std::function<void()> wake)
    : renderer_(std::move(atlas), options), wake_(std::move(wake)), thread_([this] { run(); }) {}

/// Changes the shared state, and wakes the thread.
template <typename Change>
void RenderWorker::change(const Change& apply) {
  {
    const std::lock_guard lock(mutex_);
    apply();
  }
  changed_.notify_one();
}

RenderWorker::~RenderWorker() {
  change([this] { stop_ = true; });
  thread_.join();
}

void RenderWorker::show(FrameRequest request) {
  change([&] {
    request_ = std::move(request);
    unrefined_.reset();
    refine_at_ = Clock::now() + kStill;
  });
}

void RenderWorker::pick(double u, double v, PickPurpose purpose) {
  change([&] { picks_[static_cast<std::size_t>(purpose)] = Point{u, v}; });
}

void RenderWorker::save(FrameRequest request, std::filesystem::path path) {
  change([&] { saves_.push_back({std::move(request), std::move(path)}); });
}

std::vector<WorkerEvent> RenderWorker::take_events() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

void RenderWorker::push_event(WorkerEvent event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
  }
  wake_();
}

/// The most urgent pending pick: clicks before the pointer.
std::optional<PickPurpose> RenderWorker::next_pick() const {
  for (const auto purpose : {PickPurpose::kClick, PickPurpose::kFraming, PickPurpose::kPointer}) {
    if (picks_[static_cast<std::size_t>(purpose)]) return purpose;
  }
  return std::nullopt;
}

/// Waits for a request or for the time to refine. Returns false when the thread must end.
bool RenderWorker::wait_for_work(std::unique_lock<std::mutex>& lock) {
  const auto urgent = [this] { return stop_ || request_ || next_pick() || !saves_.empty(); };
  while (!urgent()) {
    if (!unrefined_) {
      changed_.wait(lock);
    } else if (changed_.wait_until(lock, refine_at_) == std::cv_status::timeout) {
      break;
    }
  }
  return !stop_;
}

void RenderWorker::run() {
  std::unique_lock lock(mutex_);
  while (wait_for_work(lock)) {
    if (request_) {
      const FrameRequest request = *std::exchange(request_, std::nullopt);
      lock.unlock();
      render_frame(request, Quality::kDraft);
    } else if (const auto purpose = next_pick()) {
      const Point point = *std::exchange(picks_[static_cast<std::size_t>(*purpose)], std::nullopt);
      lock.unlock();
      answer(point, *purpose);
    } else if (!saves_.empty()) {
      const SaveJob job = std::move(saves_.front());
      saves_.erase(saves_.begin());
      lock.unlock();
      save_picture(job);
    } else if (unrefined_) {
      const FrameRequest request = *std::exchange(unrefined_, std::nullopt);
      lock.unlock();
      render_frame(request, Quality::kNormal);
    }
    lock.lock();
  }
}

Result<void> RenderWorker::select(const FrameRequest& request) {
  if (request.selection == selected_) return {};
  if (auto selected = renderer_.select(*request.selection); !selected) return selected;
  selected_ = request.selection;
  return {};
}

Result<void> RenderWorker::render(const FrameRequest& request, Quality quality, Frame& frame) {
  if (auto selected = select(request); !selected) return selected;
  RenderOptions options;
  const int divisor = quality == Quality::kDraft ? draft_divisor_ : 1;
  options.size = {std::max(1, request.size.width / divisor), std::max(1, request.size.height / divisor)};
  options.quality = quality;
  options.depth_cue = request.depth_cue;
  options.cuts = request.cuts;
  options.draft_budget_ms = kDraftBudgetMs;
  return renderer_.render(request.camera, options, frame);
}

/// Description of the first missing part, and the number of others.
std::string RenderWorker::missing_text(const std::vector<MissingPart>& missing) const {
  if (missing.empty()) return {};
  const std::string first = describe(missing.front(), renderer_.atlas().graph());
  return missing.size() == 1 ? first : fmt::format("{} (and {} more)", first, missing.size() - 1);
}

/// Replaces the target of a request by the camera that fits it. Reports either the camera or a failure.
bool RenderWorker::fit_camera(FrameRequest& request) {
  const auto fit = [&]() -> Result<Camera> {
    if (auto selected = select(request); !selected) return tl::unexpected(std::move(selected).error());
    const RenderOptions options{.size = request.size,
                                .quality = Quality::kDraft,
                                .draft_budget_ms = kDraftBudgetMs,
                                .cuts = request.cuts};
    if (!request.fit->structure) return renderer_.fit(request.camera, options);
    const auto part = renderer_.atlas().graph().descendants(*request.fit->structure);
    return renderer_.fit(request.camera, options, part);
  };
  Result<Camera> camera = guarded(fit);
  if (!camera) {
    push_event(FrameFailed{request, std::move(camera).error()});
    return false;
  }
  camera->zoom = std::clamp(camera->zoom * request.fit->zoom, kMinZoom, kMaxZoom);
  if (request.fit->center_lps_mm) camera->center_lps_mm = request.fit->center_lps_mm;
  push_event(CameraFitted{request, *camera});
  request.camera = *camera;
  request.fit.reset();
  return true;
}

void RenderWorker::render_frame(FrameRequest request, Quality quality) {
  if (request.fit && !fit_camera(request)) return;
  const auto make_frame = [&]() -> Result<std::shared_ptr<const DisplayFrame>> {
    if (auto rendered = render(request, quality, latest_); !rendered)
      return tl::unexpected(std::move(rendered).error());
    return std::make_shared<const DisplayFrame>(DisplayFrame{request, latest_.picture.size,
                                                             to_srgb8(latest_.picture, kBackground), quality,
                                                             latest_.stats, missing_text(latest_.missing)});
  };
  Result<std::shared_ptr<const DisplayFrame>> frame = guarded(make_frame);
  if (!frame) {
    push_event(FrameFailed{request, std::move(frame).error()});
    return;
  }
  const bool draft = quality == Quality::kDraft;
  if (draft) {
    const double ms = (*frame)->stats.render_ms;
    const bool slow = ms > kSlowDraftMs;
    if (slow && was_slow_) draft_divisor_ = std::min(draft_divisor_ + 1, kMaxDraftDivisor);
    was_slow_ = slow && !was_slow_;
    if (ms < kQuickDraftMs) draft_divisor_ = std::max(draft_divisor_ - 1, 1);
    const std::lock_guard lock(mutex_);
    if (!request_) unrefined_ = std::move(request);
  }
  push_event(FrameDone{*std::move(frame), !draft});
}

void RenderWorker::answer(const Point& point, PickPurpose purpose) {
  const auto pick = guarded([&]() -> Result<std::optional<Pick>> {
    const auto [width, height] = latest_.picture.size;
    return latest_.pick(point.u * width, point.v * height);
  });
  Picked picked{.purpose = purpose, .structure = std::nullopt};
  if (pick && *pick) picked.structure = (*pick)->structure;
  push_event(picked);
}

void RenderWorker::save_picture(const SaveJob& job) {
  Result<void> result = guarded([&]() -> Result<void> {
    Frame frame;
    if (auto rendered = render(job.request, Quality::kHigh, frame); !rendered) return rendered;
    return write_png(frame.picture, job.path, kBackground);
  });
  push_event(PictureSaved{job.path, std::move(result)});
}

}  // namespace splatlas
