// What the window knows and does, without a window system: one open atlas being looked at.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "player/window/render_worker.h"
#include "player/window/selection_editor.h"
#include "player/window/session_log.h"
#include "player/window/structure_rows.h"

namespace splatlas {

/// A message to the user.
struct Status {
  std::string text;
  bool error = false;
  friend bool operator==(const Status&, const Status&) = default;
};

/// A structure with what there is to say about it.
struct StructureFacts {
  StructureIndex structure = kNoStructure;
  std::vector<std::string> paths;  ///< at most kMaxPaths
  std::uint64_t voxels = 0, triangles = 0;
  double millilitres = 0;
};
inline constexpr std::size_t kMaxPaths = 6;

/// A place in the view, as fractions of its width and height from the top left.
struct ViewPoint {
  double u = 0, v = 0;
  friend bool operator==(const ViewPoint&, const ViewPoint&) = default;
};

/// The panels change the editor, the rows and the camera as they like; update() then asks the render worker
/// for what is missing and takes what it has done. Starts with everything selected as volume, seen from
/// anterior. For the window's thread only.
class Session {
 public:
  /// `wake` is called on another thread when update() has something to do.
  Session(std::shared_ptr<const Atlas> atlas, const RendererOptions& options, std::function<void()> wake,
          SessionLog log = {});

  [[nodiscard]] const Atlas& atlas() const { return *atlas_; }
  [[nodiscard]] const StructureGraph& graph() const { return atlas_->graph(); }
  [[nodiscard]] SelectionEditor& editor() { return editor_; }
  [[nodiscard]] StructureRows& rows() { return rows_; }
  [[nodiscard]] const SessionLog& log() const { return log_; }

  /// To be called after every change and after every wake.
  void update();

  // What is seen.

  [[nodiscard]] const Camera& camera() const { return camera_; }
  void set_camera(const Camera& camera) { camera_ = camera; }
  /// Turned to a named view; zoom and centre stay.
  void appearance_from(NamedView view);
  /// The first view: anterior, everything in the picture.
  void reset_view() { camera_ = {}; }
  [[nodiscard]] DepthCue depth_cue() const { return depth_cue_; }
  void set_depth_cue(DepthCue cue) { depth_cue_ = cue; }
  /// Pixels of the view. Nothing is rendered before the first call.
  void resize(const PictureSize& size) { size_ = size; }

  /// The latest picture; none before the first one is done.
  [[nodiscard]] const std::shared_ptr<const Frame>& frame() const { return frame_; }
  /// A better picture than frame() is on its way.
  [[nodiscard]] bool refining() const { return refining_; }

  // What is under the pointer, and what was chosen by a click.

  /// Where the pointer is; nothing when it is elsewhere or turning the view.
  void point_at(std::optional<ViewPoint> point) { point_ = point; }
  [[nodiscard]] std::optional<StructureIndex> hovered() const { return hovered_; }
  /// Chooses what is there, or nothing where the background shows, as soon as the worker has looked.
  void click_at(ViewPoint point) { worker_.pick(point.u, point.v, true); }
  /// Chooses a structure and, if wanted, shows it in the tree.
  void choose(StructureIndex s, bool reveal);
  void choose_nothing();
  [[nodiscard]] const std::optional<StructureFacts>& current() const { return current_; }
  /// Row that was revealed and is to be scrolled to; told once.
  [[nodiscard]] std::optional<std::size_t> take_revealed_row() { return std::exchange(revealed_, {}); }

  // Text, files and messages.

  /// Sets the selection from the user's words; text_error() says what is wrong with them, if something is.
  void apply_text(std::string_view text);
  [[nodiscard]] const std::string& text_error() const { return text_error_; }
  /// Writes what is seen, in high quality, as the next free "NAME-1.png" beside the atlas, or in the working
  /// folder when that of the atlas cannot be written to. status() tells how it went.
  void save_picture();
  /// The latest message, until the selection changes.
  [[nodiscard]] const Status& status() const { return status_; }
  void tell(Status status);

 private:
  void handle(const FrameDone& done);
  void handle(const FrameFailed& failed);
  void handle(const Picked& picked);
  void handle(const PictureSaved& saved);
  void request_frame();
  void request_pick();
  void notice_selection();
  [[nodiscard]] FrameRequest wanted_frame() const;

  std::shared_ptr<const Atlas> atlas_;
  SessionLog log_;
  SelectionEditor editor_;
  StructureRows rows_;

  std::shared_ptr<const Selection> selection_;  // the editor's, of version_
  std::uint64_t version_ = 0;
  std::string good_text_;  // of the latest selection that could be rendered
  Camera camera_;
  PictureSize size_;
  DepthCue depth_cue_ = DepthCue::kNone;
  std::optional<FrameRequest> requested_;
  std::shared_ptr<const Frame> frame_;
  bool refining_ = false;

  std::optional<ViewPoint> point_, asked_;
  std::optional<StructureIndex> hovered_;
  std::optional<StructureFacts> current_;
  std::optional<std::size_t> revealed_;
  std::string text_error_;
  Status status_;
  std::uint64_t status_version_ = 0;  // a message goes when the selection is another one
  int next_picture_ = 1;

  RenderWorker worker_;  // last: its thread ends before the rest goes
};

}  // namespace splatlas
