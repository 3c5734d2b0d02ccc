// Render thread of the window.
#pragma once

#include <array>
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

#include "player/renderer.h"

namespace splatlas {

/// Content to which a camera is fitted: the selection, or its part below a structure.
struct FitTarget {
  std::optional<StructureIndex> structure = std::nullopt;
  double zoom = 1;                                   ///< multiplies that of the fit
  std::optional<Vec3> center_lps_mm = std::nullopt;  ///< in place of the middle of the content
  friend bool operator==(const FitTarget&, const FitTarget&) = default;
};

/// Request for a frame.
struct FrameRequest {
  std::shared_ptr<const Selection> selection;
  std::string text;  ///< text of the selection
  Camera camera;
  PictureSize size;
  DepthCue depth_cue = DepthCue::kNone;
  CutPlanes cuts;
  std::optional<FitTarget> fit = std::nullopt;  ///< fits the camera first; frames have no target
};

/// A frame, ready for display.
struct DisplayFrame {
  FrameRequest request;
  PictureSize size;  ///< size of `srgb8`; drafts may have fewer pixels than requested
  std::vector<std::uint8_t> srgb8;
  Quality quality = Quality::kDraft;
  RenderStats stats;
  std::string missing;  ///< one line about missing parts of a damaged file; empty for intact files
};

/// Purpose of a pick.
enum class PickPurpose : std::uint8_t { kPointer, kClick, kFraming };

// Events of the worker, in chronological order.

/// The camera of a request is fitted to its target. The frame follows.
struct CameraFitted {
  FrameRequest request;  ///< as requested
  Camera camera;
};
/// A frame is finished.
struct FrameDone {
  std::shared_ptr<const DisplayFrame> frame;
  bool final = false;  ///< true: the last frame of this request
};
/// A frame could not be rendered.
struct FrameFailed {
  FrameRequest request;
  Error error;
};
/// Answer to RenderWorker::pick().
struct Picked {
  PickPurpose purpose = PickPurpose::kPointer;
  std::optional<StructureIndex> structure;  ///< none: background
};
/// A picture was saved, or could not be saved.
struct PictureSaved {
  std::filesystem::path path;
  Result<void> result;
};
using WorkerEvent = std::variant<CameraFitted, FrameDone, FrameFailed, Picked, PictureSaved>;

/// Owns the renderer, which only the worker's thread uses.
/// Order of work: fit and draft of the latest request; picks; pictures to save; the picture in normal quality
/// once requests have paused. The resolution of drafts adapts to their render time. Call all members on the
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
  /// pending request with the same purpose.
  void pick(double u, double v, PickPurpose purpose);
  /// Renders `request` in high quality over a black background, and writes a PNG file.
  void save(FrameRequest request, std::filesystem::path path);

  /// Events since the last call.
  [[nodiscard]] std::vector<WorkerEvent> take_events();

 private:
  struct Point {
    double u = 0, v = 0;
  };
  static constexpr std::size_t kPurposes = 3;
  struct SaveJob {
    FrameRequest request;
    std::filesystem::path path;
  };
  using Clock = std::chrono::steady_clock;

  template <typename Change>
  void change(const Change& apply);
  void run();
  [[nodiscard]] bool wait_for_work(std::unique_lock<std::mutex>& lock);
  [[nodiscard]] std::optional<PickPurpose> next_pick() const;
  void push_event(WorkerEvent event);
  [[nodiscard]] Result<void> select(const FrameRequest& request);
  [[nodiscard]] Result<void> render(const FrameRequest& request, Quality quality, Frame& frame);
  [[nodiscard]] std::string missing_text(const std::vector<MissingPart>& missing) const;
  [[nodiscard]] bool fit_camera(FrameRequest& request);
  void render_frame(FrameRequest request, Quality quality);
  void answer(const Point& point, PickPurpose purpose);
  void save_picture(const SaveJob& job);

  // Shared by both threads; guarded by mutex_.
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  std::optional<FrameRequest> request_;    // pending
  std::optional<FrameRequest> unrefined_;  // shown as a draft
  Clock::time_point refine_at_;
  std::array<std::optional<Point>, kPurposes> picks_;  // pending, by purpose
  std::vector<SaveJob> saves_;
  std::vector<WorkerEvent> events_;

  // Used by the worker's thread only.
  Renderer renderer_;
  std::shared_ptr<const Selection> selected_;
  Frame latest_;  // for picks; the next one reuses its memory
  int draft_divisor_ = 1;
  bool was_slow_ = false;  // the latest draft, since the divisor was raised

  std::function<void()> wake_;
  std::thread thread_;  // last: starts after all other members exist
};

}  // namespace splatlas
