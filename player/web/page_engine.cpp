#include "player/web/page_engine.h"

#include <algorithm>
#include <exception>
#include <new>
#include <stdexcept>
#include <unordered_map>

#include <nlohmann/json.hpp>

#include "format/io/input_file.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/json_text.h"
#include "player/camera_moves.h"
#include "player/page/annotate_picture.h"
#include "player/web/page_json.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAtlasName = "atlas";

Json drawn_json(const Selection& selection) {
  Json json = Json::array();
  for (const StructureDraw& draw : selection.structures) {
    const bool is_ghost = draw.mode == DrawMode::kSurface && draw.ghost;
    Json entry = Json::array({is_ghost ? "ghost" : name_of(draw.mode)});
    if (draw.mode != DrawMode::kOff) {
      entry.push_back(draw.opacity ? Json(*draw.opacity) : Json());
      entry.push_back(to_hex(draw.color));
    }
    json.push_back(std::move(entry));
  }
  return json;
}

Json pick_json(const std::optional<Pick>& pick, const StructureGraph& graph) {
  if (!pick) return nullptr;
  return {{"index", pick->structure},
          {"id", graph[pick->structure].id},
          {"name", graph[pick->structure].name},
          {"path", graph.paths(pick->structure, 1).front()},
          {"point", pick->point_lps_mm}};
}

Result<std::vector<StructureIndex>> subtree_of(const StructureGraph& graph, int structure) {
  const auto index = static_cast<StructureIndex>(structure);
  if (index < graph.size()) return graph.descendants(index);
  return fail(ErrorCode::kNotFound, "structure {}: the atlas has {}", index, graph.size());
}

/// Fits the camera of a state to the selection, or to its part in a structure and its descendants.
Result<Camera> fit(Renderer& renderer, const PageState& state, const PageFit& fit,
                   const RenderControl& control) {
  std::optional<std::vector<StructureIndex>> part;
  if (fit.structure >= 0) {
    SPLATLAS_ASSIGN_OR_RETURN(part, subtree_of(renderer.atlas().graph(), fit.structure));
  }
  RenderOptions options = state.options;
  options.quality = Quality::kDraft;
  if (fit.size) options.size = *fit.size;
  SPLATLAS_ASSIGN_OR_RETURN(Camera camera, renderer.fit(state.camera, options, part, {}, control));
  camera = zoomed(camera, fit.zoom);
  if (fit.center_lps_mm) camera.center_lps_mm = fit.center_lps_mm;
  return camera;
}

constexpr double kMinDpi = 36, kMaxDpi = 2400;  // from 4 to 280 pixels a letter

/// Sums the widths of letters, by their bytes in UTF-8.
class LetterWidths {
 public:
  explicit LetterWidths(const Json& glyphs) {
    for (const auto& [letter, width] : glyphs.items()) widths_.emplace(letter, width.get<double>());
  }

  double operator()(std::string_view text, double size, FontStyle /*style*/) const {
    constexpr double kUnknown = 0.6;
    double sum = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      std::size_t end = begin + 1;
      while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) ++end;
      const auto found = widths_.find(std::string(text.substr(begin, end - begin)));
      sum += found == widths_.end() ? kUnknown : found->second;
      begin = end;
    }
    return sum * size;
  }

 private:
  std::unordered_map<std::string, double> widths_;
};

Result<std::vector<StructureIndex>> bearers_of(const std::vector<std::string>& names,
                                               const Renderer& renderer) {
  const StructureGraph& graph = renderer.atlas().graph();
  if (!names.empty()) return label_bearers(graph, names);
  std::vector<StructureIndex> bearers(graph.size(), kNoStructure);
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    const StructureDraw& draw = renderer.selection().structures[s];
    if (draw.mode != DrawMode::kSurface || !draw.ghost) bearers[s] = s;
  }
  return bearers;
}

Json json_of(const AnnotationLayer& layer, double label_size) {
  Json json{{"lines", Json::array()},
            {"dots", Json::array()},
            {"texts", Json::array()},
            {"unlabelled", layer.unlabelled}};
  for (const PlacedLine& one : layer.lines)
    if (one.casing > 0)  // no rule above a note
      json["lines"].push_back({one.from.x, one.from.y, one.to.x, one.to.y, one.width, to_hex(one.color),
                               one.casing, to_hex(one.casing_color)});
  for (const PlacedDot& one : layer.dots)
    json["dots"].push_back(
        {one.center.x, one.center.y, one.radius, to_hex(one.color), one.casing, to_hex(one.casing_color)});
  for (const PlacedText& one : layer.texts) {
    if (one.size < label_size) continue;  // a note about those without a label
    json["texts"].push_back({one.text, one.x, one.y, one.size, to_hex(one.color)});
  }
  return json;
}

/// Places names on a frame of this camera. kNotFound for unknown names; kUsage: too small a picture.
Result<Json> page_labels(const Json& request, const Frame& frame, const Camera& camera,
                         const Renderer& renderer) {
  SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, frame.picture.size, renderer.atlas().display()));
  SPLATLAS_ASSIGN_OR_RETURN(const auto bearers,
                            bearers_of(request.value("labels", std::vector<std::string>()), renderer));
  SPLATLAS_ASSIGN_OR_RETURN(const Rgb background, parse_color(request.at("background").get<std::string>()));
  const AnnotatedScene scene{
      .picture = frame.picture,
      .view = view,
      .background = background,
      .structures = named_structures(frame.picture, structure_at(frame), renderer.atlas().graph(),
                                     renderer.selection(), bearers)};
  AnnotationOptions options;
  options.items.labels = true;
  options.dpi = std::clamp(request.at("dpi").get<double>(), kMinDpi, kMaxDpi);
  SPLATLAS_ASSIGN_OR_RETURN(const AnnotationLayer layer,
                            annotate_picture(scene, options, LetterWidths(request.at("glyphs"))));
  return json_of(layer, 0.99 * kLabelPoints * *options.dpi / 72);
}

}  // namespace

struct PageEngine::Call {
  PageEngine& engine;
  const Json& request;
  std::vector<std::byte>& bytes;
  const RenderControl& control;

  Result<Renderer*> renderer() const {
    if (engine.renderer_) return &*engine.renderer_;
    return fail(ErrorCode::kUsage, "no atlas is open");
  }

  /// A count of bytes. Throws std::runtime_error for other numbers.
  std::uint64_t bytes_at(const char* key) const {
    constexpr double kMost = 1e15;
    const double count = request.at(key).get<double>();
    if (!(count >= 0 && count <= kMost)) throw std::runtime_error(fmt::format("{}: {}", key, count));
    return static_cast<std::uint64_t>(count);
  }

  void close() const {
    engine.frame_ = {};
    engine.renderer_.reset();
    engine.slices_.reset();
    engine.selected_.reset();
  }

  Result<Json> open() const {
    close();
    engine.remote_.reset();
    SPLATLAS_ASSIGN_OR_RETURN(auto atlas, Atlas::open_bytes(std::move(bytes), kAtlasName));
    engine.open(std::move(atlas));
    return Json();
  }

  Result<Json> open_remote() const {
    if (engine.renderer_ || !engine.remote_) engine.remote_ = std::make_shared<RemoteBytes>();
    close();
    const auto read = [remote = engine.remote_](std::uint64_t offset, std::span<std::byte> to) {
      return remote->read(offset, to);
    };
    SPLATLAS_ASSIGN_OR_RETURN(auto atlas, Atlas::open_file(InputFile(bytes_at("size"), read, kAtlasName)));
    engine.open(std::move(atlas));
    return Json();
  }

  /// A selection with missed pieces leaves them out, until it is made anew.
  Result<Json> wanted() const {
    Json ranges = Json::array();
    if (engine.remote_) {
      for (const ByteRange& range : engine.remote_->take_missed())
        ranges.push_back({range.offset, range.bytes});
    }
    if (!ranges.empty()) {
      engine.selected_.reset();
      engine.colors_.clear();
    }
    return ranges;
  }

  Result<Json> give() const {
    if (!engine.remote_) return fail(ErrorCode::kUsage, "no atlas on a server is open");
    engine.remote_->give(bytes_at("offset"), std::move(bytes));
    return Json();
  }

  /// Selects. Returns warnings.
  Result<Json> select() const {
    SPLATLAS_ASSIGN_OR_RETURN(Renderer* const renderer, this->renderer());
    const Atlas& atlas = renderer->atlas();
    const auto& text = request.at("select").get_ref<const std::string&>();
    const TaskControl task({}, {}, &atlas.work_budget());
    const auto told = [](Error error) {
      if (error.message.starts_with("selection")) error.subject = "selection";
      return error;
    };
    SPLATLAS_ASSIGN_OR_RETURN(const bool is_distinct, wants_distinct_colors(request));
    if (is_distinct && engine.colors_.empty()) {
      SPLATLAS_ASSIGN_OR_RETURN(engine.colors_, atlas.distinct_colors());
    }
    const std::span<const Rgb> colors = is_distinct ? engine.colors_ : std::span<const Rgb>();
    SPLATLAS_ASSIGN_OR_RETURN(const auto terms, parse_selection(text).map_error(told));
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection,
                              resolve_selection(terms, atlas.graph(), colors).map_error(told));
    SPLATLAS_ASSIGN_OR_RETURN(const auto warnings, selection_warnings(terms, atlas));
    engine.selected_.reset();  // a stop leaves nothing selected
    SPLATLAS_RETURN_IF_ERROR(renderer->select(selection));
    engine.selected_ = text;
    engine.is_distinct_ = is_distinct;
    engine.warnings_ = warnings;
    engine.told_ms_ = 0;
    engine.is_told_ = false;
    return Json(warnings);
  }

  bool is_other_selection() const {
    const auto text = request.find("select");
    return text != request.end() && (engine.selected_ != text->get_ref<const std::string&>() ||
                                     engine.is_distinct_ != wants_distinct_colors(request));
  }

  Result<Json> fit_camera() const {
    SPLATLAS_ASSIGN_OR_RETURN(Renderer* const renderer, this->renderer());
    SPLATLAS_ASSIGN_OR_RETURN(const PageState state, page_state_of(request));
    if (is_other_selection()) SPLATLAS_RETURN_IF_ERROR(select());
    SPLATLAS_ASSIGN_OR_RETURN(const Camera camera,
                              fit(*renderer, state, state.fit.value_or(PageFit{}), control));
    return json_of(camera);
  }

  Result<Json> draw() const {
    SPLATLAS_ASSIGN_OR_RETURN(Renderer* const renderer, this->renderer());
    SPLATLAS_ASSIGN_OR_RETURN(PageState state, page_state_of(request));
    if (is_other_selection()) SPLATLAS_RETURN_IF_ERROR(select());
    if (state.fit) {
      SPLATLAS_ASSIGN_OR_RETURN(state.camera, fit(*renderer, state, *state.fit, control));
    }
    Result<void> rendered = renderer->render(state.camera, state.options, engine.frame_, control);
    if (!rendered) {
      engine.frame_ = {};
      return tl::unexpected(std::move(rendered).error());
    }
    engine.camera_ = state.camera;
    Json answer{{"camera", json_of(state.camera)}, {"warnings", Json::array()}};
    if (!std::exchange(engine.is_told_, true)) {
      answer["warnings"] = engine.warnings_;
      answer["drawn"] = drawn_json(renderer->selection());
      for (std::size_t s = 0; engine.is_distinct_ && s < engine.colors_.size(); ++s)
        answer["colors"].push_back(to_hex(engine.colors_[s]));
    }
    const RenderStats& stats = engine.frame_.stats;
    const double select_ms = stats.select_ms - std::exchange(engine.told_ms_, stats.select_ms);
    answer["ms"] = select_ms + stats.decode_ms + stats.render_ms;
    answer["missing"] = Json::array();
    for (const MissingPart& part : engine.frame_.missing)
      answer["missing"].push_back(describe(part, renderer->atlas().graph()));
    return answer;
  }

  Result<Json> light() const {
    constexpr int kStep = 4;  // pixels: picks of all take a second
    SPLATLAS_ASSIGN_OR_RETURN(const Renderer* const renderer, this->renderer());
    const StructureGraph& graph = renderer->atlas().graph();
    SPLATLAS_ASSIGN_OR_RETURN(const auto subtree, subtree_of(graph, request.at("structure").get<int>()));
    std::vector<bool> is_lit(graph.size());
    for (const StructureIndex s : subtree) is_lit[s] = true;
    const auto [width, height] = engine.frame_.picture.size;
    const auto structure = structure_at(engine.frame_);
    Json rows = Json::array();
    for (int y = kStep / 2; y < height; y += kStep) {
      std::string& row = rows.emplace_back("").get_ref<std::string&>();
      for (int x = kStep / 2; x < width; x += kStep) {
        const StructureIndex shown = structure(x, y);
        row += shown != kNoStructure && is_lit[shown] ? '1' : '0';
      }
    }
    return rows;
  }

  Result<Json> slice() const {
    SPLATLAS_ASSIGN_OR_RETURN(const Renderer* const renderer, this->renderer());
    const TaskControl task(control.stop, {}, &renderer->atlas().work_budget());
    return engine.slices_->slice(request.at("axis").get<int>(), request.at("index").get<std::int64_t>());
  }

  Result<Json> labels() const {
    SPLATLAS_ASSIGN_OR_RETURN(const Renderer* const renderer, this->renderer());
    if (engine.frame_.picture.rgba.empty()) return fail(ErrorCode::kUsage, "there is no picture");
    return page_labels(request, engine.frame_, engine.camera_, *renderer);
  }

  Result<Json> pick() const {
    SPLATLAS_ASSIGN_OR_RETURN(const Renderer* const renderer, this->renderer());
    const Json& at = request.at("at");
    const auto pick = engine.frame_.pick(at.at(0).get<double>(), at.at(1).get<double>());
    return pick_json(pick, renderer->atlas().graph());
  }

  Result<std::string> text() const {
    const auto& name = request.at("call").get_ref<const std::string&>();
    if (name == "info") {
      SPLATLAS_ASSIGN_OR_RETURN(const Renderer* const renderer, this->renderer());
      return info_json(renderer->atlas());
    }
    SPLATLAS_ASSIGN_OR_RETURN(const Json answer, by_name(name));
    return json_text(answer, -1);
  }

  Result<Json> by_name(const std::string& name) const {
    if (name == "draw") return draw();
    if (name == "pick") return pick();
    if (name == "labels") return labels();
    if (name == "light") return light();
    if (name == "slice") return slice();
    if (name == "fit") return fit_camera();
    if (name == "select") return select();
    if (name == "open") return open();
    if (name == "openRemote") return open_remote();
    if (name == "wanted") return wanted();
    if (name == "give") return give();
    return fail(ErrorCode::kUsage, "{}: no such call", name);
  }
};

void PageEngine::open(std::shared_ptr<const Atlas> atlas) {
  slices_.emplace(atlas);
  renderer_.emplace(std::move(atlas), options_);
  selected_.reset();
  colors_.clear();
}

PageAnswer PageEngine::call(std::string_view request, std::vector<std::byte> bytes,
                            const RenderControl& control) {
  const auto failed = [](ErrorCode code, const char* message) {
    return PageAnswer{.status = 1 + static_cast<int>(code), .text = message};
  };
  try {
    const Json json = Json::parse(request);
    const Result<std::string> text = Call{*this, json, bytes, control}.text();
    if (!text) {
      PageAnswer answer = failed(text.error().code, text.error().message.c_str());
      answer.subject = text.error().subject;
      return answer;
    }
    return {.text = *text, .has_picture = json.at("call") == "draw"};
  } catch (const std::bad_alloc&) {
    return failed(ErrorCode::kLimit, "out of memory");
  } catch (const nlohmann::json::exception& error) {
    return failed(ErrorCode::kUsage, error.what());
  } catch (const std::exception& error) {
    return failed(ErrorCode::kFailed, error.what());
  }
}

}  // namespace splatlas
