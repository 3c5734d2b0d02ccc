// Render thread of the window.
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

/// Request for a frame.
struct FrameRequest {
  std::shared_ptr<const Selection> selection;
  std::string text;  ///< text of the selection
  Camera camera;
  PictureSize size;
  DepthCue depth_cue = DepthCue::kNone;
};

/// Rendered frame, ready for display.
struct Frame {
  FrameRequest request;
  PictureSize size;  ///< size of `srgb8`; drafts may have fewer pixels than requested
  std::vector<std::uint8_t> srgb8;
  Quality quality = Quality::kDraft;
  RenderStats stats;
  std::string missing;  ///< one line about missing parts of a damaged file; empty for intact files
};

// Events of the worker, in chronological order.

/// A frame is finished.
struct FrameDone {
  std::shared_ptr<const Frame> frame;
  bool final = false;  ///< true: the last frame of this request
};
/// A frame could not be rendered.
struct FrameFailed {
  FrameRequest request;
  Error error;
};
/// Answer to RenderWorker::pick().
struct Picked {
  bool click = false;                       ///< `click` of the question
  std::optional<StructureIndex> structure;  ///< none: background
};
/// A picture was saved, or could not be saved.
struct PictureSaved {
  std::filesystem::path path;
  Result<void> result;
};
using WorkerEvent = std::variant<FrameDone, FrameFailed, Picked, PictureSaved>;

/// Owns the renderer, which only the worker's thread uses.
/// Order of work: draft of the latest request; picks; pictures to save; the picture in normal quality once
/// requests have paused. The resolution of drafts adapts to their render time. Call all members on the
/// window's thread.
class RenderWorker {
 public:
  /// Calls `wake` on the worker's thread after each new event.
  RenderWorker(std::shared_ptr<const Atlas> atlas, const RendererOptions& options,
               std::function<void()> wake);
  /// Waits for the end of the current frame.
  ~RenderWorker();
  RenderWorker(const RenderWorker&) = delete;
  RenderWorker& operator=(const RenderWorker&) = delete;

  /// Requests a frame. Replaces a pending request.
  void show(FrameRequest request);
  /// Requests the structure at (u, v), as fractions of the width and height of the latest picture. Replaces a
  /// pending request with the same `click`.
  void pick(double u, double v, bool click);
  /// Renders `request` in high quality over a black background, and writes a PNG file.
  void save(FrameRequest request, std::filesystem::path path);

  /// Events since the last call.
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

  template <typename Change>
  void change(const Change& apply);
  void run();
  [[nodiscard]] bool wait_for_work(std::unique_lock<std::mutex>& lock);
  void push_event(WorkerEvent event);
  [[nodiscard]] Result<void> select(const FrameRequest& request);
  [[nodiscard]] Result<Picture> render(const FrameRequest& request, Quality quality);
  [[nodiscard]] std::string missing_text() const;
  void render_frame(const FrameRequest& request, Quality quality);
  void answer(const Point& point);
  void save_picture(const SaveJob& job);

  // Shared by both threads; guarded by mutex_.
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  std::optional<FrameRequest> request_;    // pending
  std::optional<FrameRequest> unrefined_;  // shown as a draft
  Clock::time_point refine_at_;
  std::optional<Point> pointer_, click_;  // pending
  std::vector<SaveJob> saves_;
  std::vector<WorkerEvent> events_;

  // Used by the worker's thread only.
  Renderer renderer_;
  std::shared_ptr<const Selection> selected_;
  PictureSize rendered_;  // size of the renderer's latest picture
  int draft_divisor_ = 1;

  std::function<void()> wake_;
  std::thread thread_;  // last: starts after all other members exist
};

}  // namespace splatlas
