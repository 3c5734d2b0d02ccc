// State of a viewing session, independent of the window system.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "player/window/session/render_worker.h"
#include "player/window/session/selection_editor.h"
#include "player/window/session/session_log.h"
#include "player/window/session/structure_rows.h"

namespace splatlas {

/// A message to the user.
struct Status {
  std::string text;
  bool error = false;
  friend bool operator==(const Status&, const Status&) = default;
};

/// Facts about a structure for display.
struct StructureFacts {
  StructureIndex structure = kNoStructure;
  std::vector<std::string> paths;  ///< at most kMaxPaths paths from a root
  std::uint64_t voxels = 0, triangles = 0;
  double millilitres = 0;
};
inline constexpr std::size_t kMaxPaths = 6;

/// Position in the view, as fractions of its width and height from the top left.
struct ViewPoint {
  double u = 0, v = 0;
  friend bool operator==(const ViewPoint&, const ViewPoint&) = default;
};

/// One open atlas with camera, selection and render worker.
/// Panels change the editor, the rows and the camera; update() then exchanges requests and events with the
/// worker. Starts with all structures as volumes in an anterior view that they fill. For the window's thread
/// only.
class Session {
 public:
  /// Calls `wake` on another thread when update() has events to process.
  Session(std::shared_ptr<const Atlas> atlas, const RendererOptions& options, std::function<void()> wake,
          SessionLog log = {});

  [[nodiscard]] const Atlas& atlas() const { return *atlas_; }
  [[nodiscard]] const StructureGraph& graph() const { return atlas_->graph(); }
  [[nodiscard]] SelectionEditor& editor() { return editor_; }
  [[nodiscard]] StructureRows& rows() { return rows_; }
  [[nodiscard]] const SessionLog& log() const { return log_; }

  /// Processes events and requests frames. Call it after each change and each wake.
  void update();

  // View and picture.

  [[nodiscard]] const Camera& camera() const { return camera_; }
  void set_camera(const Camera& camera) { camera_ = camera; }
  /// Turns the camera to a standard view; keeps zoom and centre.
  void turn_to(NamedView view);
  /// Fits the view to the selection, in the present direction. The camera changes once the worker has
  /// answered; changes of the camera before that keep their direction only. Later changes of the selection do
  /// not move it.
  void frame_selection() { framing_ = FitTarget(); }
  /// The same for a structure with its descendants.
  void frame_structure(StructureIndex s) { framing_ = FitTarget{s}; }
  /// The same for the structure at this point, or for the selection at the background, after an answer of the
  /// worker.
  void frame_at(ViewPoint point) { worker_.pick(point.u, point.v, PickPurpose::kFraming); }
  /// Returns to an anterior view, fitted to the selection, without cuts.
  void reset_view() {
    camera_ = {};
    cuts_ = {};
    frame_selection();
  }
  /// Shows a scene of the atlas: its selection and view. status() reports a selection that fails.
  void show_scene(std::size_t n);
  /// The scene shown; none after a change of the selection.
  [[nodiscard]] std::optional<std::size_t> scene() const {
    return scene_version_ == editor_.version() ? scene_ : std::nullopt;
  }
  /// True while the scene shows its question, not its caption.
  [[nodiscard]] bool asks() const { return scene() && !answered_; }
  /// Shows the answer to a question, then the next scene, or the one before; the first or last one if none is
  /// shown.
  void show_next_scene();
  void show_scene_before();
  /// Zoom relative to the latest fit.
  [[nodiscard]] double zoom() const { return camera_.zoom / fitted_zoom_; }
  [[nodiscard]] DepthCue depth_cue() const { return depth_cue_; }
  void set_depth_cue(DepthCue cue) { depth_cue_ = cue; }
  /// Sets the size of the view in pixels. Rendering starts after the first call.
  void resize(const PictureSize& size) { size_ = size; }

  /// The latest frame; null before the first one.
  [[nodiscard]] const std::shared_ptr<const DisplayFrame>& frame() const { return frame_; }
  /// True while a better frame than frame() is being rendered.
  [[nodiscard]] bool refining() const { return refining_; }

  // Structure under the pointer, and current structure.

  /// Sets the position of the pointer; none outside the view and during drags.
  void point_at(std::optional<ViewPoint> point) { point_ = point; }
  [[nodiscard]] std::optional<StructureIndex> hovered() const { return hovered_; }
  /// Makes the structure at this point current, or none for the background, after an answer of the worker.
  void click_at(ViewPoint point) { worker_.pick(point.u, point.v, PickPurpose::kClick); }
  /// Makes a structure current. `reveal`: also shows it in the tree.
  void choose(StructureIndex s, bool reveal);
  void choose_nothing();
  [[nodiscard]] const std::optional<StructureFacts>& current() const { return current_; }
  /// Returns the revealed row to scroll to, once.
  [[nodiscard]] std::optional<std::size_t> take_revealed_row() { return std::exchange(revealed_, {}); }

  /// Missing parts of the first picture that was shown without them; empty for an intact atlas.
  [[nodiscard]] const std::string& missing() const { return missing_; }

  // Text, files and messages.

  /// Sets the selection from text. Invalid text sets text_error(); a hidden term sets status().
  void apply_text(std::string_view text);
  [[nodiscard]] const std::string& text_error() const { return text_error_; }
  /// Renders the view in high quality and writes it as the next unused "NAME-1.png". The folder is that of
  /// the atlas, or the working folder if the former is read-only. status() reports the result.
  void save_picture();
  /// The latest message. A change of selection clears it.
  [[nodiscard]] const Status& status() const { return status_; }
  void set_status(Status status);

 private:
  void handle(const CameraFitted& fitted);
  void handle(const FrameDone& done);
  void handle(const FrameFailed& failed);
  void handle(const Picked& picked);
  void handle(const PictureSaved& saved);
  [[nodiscard]] FrameRequest wanted_frame() const;
  void request_frame();
  void request_pick();
  void notice_selection();
  void warn_of_hidden_terms(std::string_view text);

  std::shared_ptr<const Atlas> atlas_;
  SessionLog log_;
  SelectionEditor editor_;
  StructureRows rows_;

  std::shared_ptr<const Selection> selection_;  // copy of the editor's selection at version_
  std::uint64_t version_ = 0;
  std::string good_text_;  // text of the latest selection that could be rendered
  Camera camera_;
  std::optional<FitTarget> framing_ = FitTarget();  // pending fit
  double fitted_zoom_ = 1;
  PictureSize size_;
  DepthCue depth_cue_ = DepthCue::kNone;
  CutPlanes cuts_;
  std::optional<std::size_t> scene_;
  bool answered_ = true;             // or the scene has no question
  std::uint64_t scene_version_ = 0;  // editor version of scene_
  std::optional<FrameRequest> requested_;
  std::shared_ptr<const DisplayFrame> frame_;
  bool refining_ = false;

  std::optional<ViewPoint> point_, asked_;
  std::optional<StructureIndex> hovered_;
  std::optional<StructureFacts> current_;
  std::optional<std::size_t> revealed_;
  std::string missing_, text_error_;
  Status status_;
  std::uint64_t status_version_ = 0;  // editor version of status_
  int next_picture_ = 1;

  RenderWorker worker_;  // last: its thread ends before the other members are destroyed
};

}  // namespace splatlas
