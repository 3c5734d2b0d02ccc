#include "player/window/session/session.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "player/camera_moves.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxPictures = 9999;

std::vector<bool> drawable_structures(const Atlas& atlas) {
  std::vector<bool> drawable(atlas.graph().size());
  for (StructureIndex s = 0; s < drawable.size(); ++s) {
    drawable[s] = !atlas.tree().interior_classes(s).empty() || !atlas.tree().boundary_classes(s).empty() ||
                  atlas.triangles(s) > 0;
  }
  return drawable;
}

StructureFacts facts_of(const Atlas& atlas, StructureIndex s) {
  StructureFacts facts{.structure = s, .paths = atlas.graph().paths(s, kMaxPaths)};
  const DecisionTree::VoxelCounts counts = atlas.tree().voxel_counts(s);
  facts.voxels = counts.interior + counts.boundary;
  for (const StructureIndex d : atlas.graph().descendants(s)) facts.triangles += atlas.triangles(d);
  facts.millilitres = static_cast<double>(facts.voxels) * voxel_volume_mm3(atlas.grid()) / 1000.0;
  return facts;
}

/// The first unused file name with a number of at least `n`. Sets `n` to the next number.
Result<std::filesystem::path> next_picture_path(const std::filesystem::path& atlas, int& n) {
  std::filesystem::path folder = atlas.parent_path();
  if (folder.empty()) folder = ".";
  if (access(folder.c_str(), W_OK) != 0) folder = ".";
  while (n <= kMaxPictures) {
    std::filesystem::path path = folder / fmt::format("{}-{}.png", atlas.stem().string(), n++);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return path;
  }
  return fail(ErrorCode::kFailed, fmt::format("{}: already holds {} pictures of {}; move them away",
                                              folder.string(), kMaxPictures, atlas.stem().string()));
}

bool same_camera(const Camera& a, const Camera& b) {
  return a.azimuth_deg == b.azimuth_deg && a.elevation_deg == b.elevation_deg && a.zoom == b.zoom &&
         a.center_lps_mm == b.center_lps_mm;
}

/// True if both requests yield the same frame.
bool same_frame(const FrameRequest& a, const FrameRequest& b) {
  return a.selection == b.selection && a.size == b.size && a.depth_cue == b.depth_cue && a.cuts == b.cuts &&
         a.fit == b.fit && same_camera(a.camera, b.camera);
}

Json camera_json(const Camera& camera) {
  Json json{{"azimuth", camera.azimuth_deg}, {"elevation", camera.elevation_deg}, {"zoom", camera.zoom}};
  if (camera.center_lps_mm) json["center_lps_mm"] = *camera.center_lps_mm;
  return json;
}

Json structure_json(const StructureGraph& graph, std::optional<StructureIndex> s) {
  if (!s) return {{"structure", nullptr}, {"name", nullptr}};
  return {{"structure", graph[*s].id}, {"name", graph[*s].name}};
}

}  // namespace

Session::Session(std::shared_ptr<const Atlas> atlas, const RendererOptions& options,
                 std::function<void()> wake, SessionLog log)
    : atlas_(std::move(atlas)),
      log_(std::move(log)),
      editor_(atlas_->graph(), drawable_structures(*atlas_)),
      rows_(atlas_->graph()),
      worker_(atlas_, options, std::move(wake)) {}

void Session::update() {
  for (const WorkerEvent& event : worker_.take_events()) {
    std::visit([this](const auto& e) { handle(e); }, event);
  }
  notice_selection();
  request_frame();
  request_pick();
}

void Session::notice_selection() {
  if (selection_ && version_ == editor_.version()) return;
  version_ = editor_.version();
  selection_ = std::make_shared<const Selection>(editor_.selection());
  text_error_.clear();
  if (status_version_ != version_) status_ = {};
  log_.write("selection", {{"text", editor_.text()}});
}

FrameRequest Session::wanted_frame() const {
  return {selection_, editor_.text(), camera_, size_, depth_cue_, cuts_, framing_};
}

void Session::request_frame() {
  if (size_.width < 1 || size_.height < 1) return;
  FrameRequest wanted = wanted_frame();
  if (requested_ && same_frame(*requested_, wanted)) return;
  requested_ = std::move(wanted);
  refining_ = true;
  worker_.show(*requested_);
}

void Session::request_pick() {
  if (!point_ || !frame_) {
    asked_.reset();
    if (hovered_) {
      hovered_.reset();
      log_.write("pointer", structure_json(graph(), hovered_));
    }
    return;
  }
  if (asked_ == point_) return;
  asked_ = point_;
  worker_.pick(point_->u, point_->v, PickPurpose::kPointer);
}

/// Takes over the camera, unless a newer request is about to replace this one.
void Session::handle(const CameraFitted& fitted) {
  if (!same_frame(wanted_frame(), fitted.request)) return;
  camera_ = fitted.camera;
  fitted_zoom_ = camera_.zoom;
  framing_.reset();
  requested_ = wanted_frame();  // the worker goes on with it
}

void Session::handle(const FrameDone& done) {
  frame_ = done.frame;
  const FrameRequest& request = frame_->request;
  const bool latest = requested_ && same_frame(*requested_, request);
  refining_ = !(latest && done.final);
  good_text_ = request.text;
  asked_.reset();  // the new frame may show another structure under the pointer
  if (missing_.empty()) missing_ = frame_->missing;
  if (latest && !frame_->missing.empty()) set_status({frame_->missing, true});
  if (!log_.on()) return;
  log_.write("picture", {{"quality", frame_->quality == Quality::kDraft ? "draft" : "normal"},
                         {"final", !refining_},
                         {"size", {frame_->size.width, frame_->size.height}},
                         {"camera", camera_json(request.camera)},
                         {"selection", request.text},
                         {"ms", frame_->stats.render_ms}});
}

/// Keeps the latest picture, and returns to the latest selection that could be rendered.
void Session::handle(const FrameFailed& failed) {
  refining_ = false;
  const bool of_this_selection = failed.request.selection == selection_ && version_ == editor_.version();
  if (of_this_selection && editor_.text() != good_text_) editor_.revert_to(good_text_);
  set_status({failed.error.message, true});
}

void Session::handle(const Picked& picked) {
  switch (picked.purpose) {
    case PickPurpose::kClick: return picked.structure ? choose(*picked.structure, true) : choose_nothing();
    case PickPurpose::kFraming:
      return picked.structure ? frame_structure(*picked.structure) : frame_selection();
    case PickPurpose::kPointer: break;
  }
  if (!point_ || hovered_ == picked.structure) return;
  hovered_ = picked.structure;
  log_.write("pointer", structure_json(graph(), hovered_));
}

void Session::handle(const PictureSaved& saved) {
  set_status(saved.result ? Status{fmt::format("Saved {}", saved.path.string()), false}
                          : Status{saved.result.error().message, true});
}

void Session::turn_to(NamedView view) {
  const Camera named = Camera::of(view);
  camera_.azimuth_deg = named.azimuth_deg;
  camera_.elevation_deg = named.elevation_deg;
}

void Session::show_scene(std::size_t n) {
  const Scene& scene = atlas_->scenes()[n];
  const Result<SceneFraming> framing = framing_of(scene, *atlas_);
  if (!framing) return set_status({framing.error().message, true});
  apply_text(scene.selection);
  if (!text_error_.empty()) {
    set_status({fmt::format("scene \"{}\": {}", scene.name, text_error_), true});
    return;
  }
  camera_ = {.azimuth_deg = scene.azimuth_deg, .elevation_deg = scene.elevation_deg};
  framing_ = FitTarget{.zoom = scene.zoom, .center_lps_mm = framing->center_lps_mm};
  cuts_ = framing->cuts;
  scene_ = n;
  answered_ = scene.question.empty();
  scene_version_ = editor_.version();
  log_.write("scene", {{"name", scene.name}});
}

void Session::show_next_scene() {
  if (asks()) {
    answered_ = true;
    return;
  }
  const std::size_t next = scene() ? *scene() + 1 : 0;
  if (next < atlas_->scenes().size()) show_scene(next);
}

void Session::show_scene_before() {
  const std::size_t next = scene().value_or(atlas_->scenes().size());
  if (next > 0) show_scene(next - 1);
}

void Session::choose(StructureIndex s, bool reveal) {
  if (!current_ || current_->structure != s) {
    current_ = facts_of(*atlas_, s);
    log_.write("current", structure_json(graph(), s));
  }
  if (reveal) revealed_ = rows_.reveal(s);
}

void Session::choose_nothing() {
  if (current_) log_.write("current", structure_json(graph(), std::nullopt));
  current_.reset();
}

void Session::apply_text(std::string_view text) {
  const Result<void> applied = editor_.set_text(text);
  if (applied) warn_of_hidden_terms(text);
  const std::string error = applied ? std::string() : applied.error().message;
  if (error != text_error_ && !error.empty()) log_.write("text_error", {{"text", error}});
  text_error_ = error;
}

void Session::warn_of_hidden_terms(std::string_view text) {
  const auto terms = parse_selection(text);
  if (!terms) return;
  const auto hidden = find_hidden_terms(*terms, graph(), atlas_->tree());
  if (hidden && !hidden->empty()) set_status({"warning: " + hidden->front().message, false});
}

void Session::save_picture() {
  if (!requested_) return;
  Result<std::filesystem::path> path = next_picture_path(atlas_->name(), next_picture_);
  if (!path) {
    set_status({path.error().message, true});
    return;
  }
  set_status({fmt::format("Saving {} ...", path->string()), false});
  worker_.save(*requested_, *std::move(path));
}

void Session::set_status(Status status) {
  status_version_ = editor_.version();
  if (status == status_) return;
  status_ = std::move(status);
  log_.write("status", {{"text", status_.text}, {"error", status_.error}});
}

}  // namespace splatlas
