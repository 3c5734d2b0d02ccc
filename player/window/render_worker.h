// Renders for the window on a thread of its own, so that the window never waits.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "player/render_frame.h"

namespace splatlas {

/// What the window wants to show.
struct FrameRequest {
  std::shared_ptr<const Selection> selection;
  std::string text;  ///< of the selection
  Camera camera;
  PictureSize size;
  DepthCue depth_cue = DepthCue::kNone;
};

/// A picture on its way to the screen.
struct Frame {
  FrameRequest request;
  PictureSize size;  ///< of `srgb8`: a draft may have fewer pixels than asked for
  std::vector<std::uint8_t> srgb8;
  Quality quality = Quality::kDraft;
  RenderStats stats;
  std::string missing;  ///< what it lacks for damage of the file, in one line; empty as a rule
};

// What the worker has to tell, in the order in which it happened.

struct FrameDone {
  std::shared_ptr<const Frame> frame;
  bool final = false;  ///< nothing better will follow for this request
};
struct FrameFailed {
  FrameRequest request;
  Error error;
};
struct Picked {
  bool click = false;                       ///< as asked
  std::optional<StructureIndex> structure;  ///< nothing where the background shows
};
struct PictureSaved {
  std::filesystem::path path;
  Result<void> result;
};
using WorkerEvent = std::variant<FrameDone, FrameFailed, Picked, PictureSaved>;

/// Owns the renderer; everything that touches it happens on the worker's thread, one thing at a time: the
/// latest request as a draft, then what is under the pointer, then pictures to save, then, once requests have
/// paused, the picture in normal quality. Drafts get fewer pixels where they would take too long to turn
/// smoothly. All members may be called from the window's thread only.
class RenderWorker {
 public:
  /// `wake` is called on the worker's thread whenever there is something to take.
  RenderWorker(std::shared_ptr<const Atlas> atlas, const RendererOptions& options,
               std::function<void()> wake);
  /// Waits for the frame that is being rendered.
  ~RenderWorker();
  RenderWorker(const RenderWorker&) = delete;
  RenderWorker& operator=(const RenderWorker&) = delete;

  /// Replaces an older request that was not begun.
  void show(FrameRequest request);
  /// Asks what is at (u, v), fractions of the width and height of the latest picture: because the pointer is
  /// there, or because of a click. Replaces an older question of the same kind.
  void pick(double u, double v, bool click);
  /// Renders `request` in high quality and writes it over black.
  void save(FrameRequest request, std::filesystem::path path);

  /// Everything that happened since the last call.
  [[nodiscard]] std::vector<WorkerEvent> take_events();

 private:
  struct Point {
    double u = 0, v = 0;
    bool click = false;
  };
  struct SaveJob {
    FrameRequest request;
    std::filesystem::path path;
  };
  using Clock = std::chrono::steady_clock;

  void run();
  [[nodiscard]] bool wait_for_work(std::unique_lock<std::mutex>& lock);
  void tell(WorkerEvent event);
  [[nodiscard]] Result<void> select(const FrameRequest& request);
  [[nodiscard]] Result<Picture> render(const FrameRequest& request, Quality quality);
  [[nodiscard]] std::string missing_text() const;
  void render_frame(const FrameRequest& request, Quality quality);
  void answer(const Point& point);
  void save_picture(const SaveJob& job);
  [[nodiscard]] PictureSize draft_size(const PictureSize& size) const;
  void adapt_drafts(double ms);

  // Between the threads, under mutex_.
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  std::optional<FrameRequest> request_;    // not begun
  std::optional<FrameRequest> unrefined_;  // shown as a draft
  Clock::time_point refine_at_;
  std::optional<Point> pointer_, click_;  // not answered
  std::vector<SaveJob> saves_;
  std::vector<WorkerEvent> events_;

  // Of the worker's thread.
  Renderer renderer_;
  std::shared_ptr<const Selection> selected_;
  PictureSize rendered_;  // size of the renderer's latest picture
  int draft_divisor_ = 1;

  std::function<void()> wake_;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace splatlas
