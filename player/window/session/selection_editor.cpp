#include "player/window/session/selection_editor.h"

#include <algorithm>

namespace splatlas {
namespace {

constexpr std::size_t kMaxUndoSteps = 200;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Equality of selections except for term numbers.
bool draw_alike(const Selection& a, const Selection& b) {
  return std::equal(a.structures.begin(), a.structures.end(), b.structures.begin(), b.structures.end(),
                    [](StructureDraw x, const StructureDraw& y) {
                      x.term = y.term;
                      return x == y;
                    });
}

/// Equality except for the colour, which differs among the descendants of a group.
bool alike_but_for_color(const StructureDraw& a, const StructureDraw& b) {
  return a.mode == b.mode && a.opacity == b.opacity && a.volume == b.volume && a.ghost == b.ghost;
}

bool is_on(const StructureDraw& draw) {
  return draw.mode != DrawMode::kOff;
}

}  // namespace

SelectionEditor::SelectionEditor(const StructureGraph& graph, std::vector<bool> drawable)
    : graph_(graph), drawable_(std::move(drawable)) {
  const std::string text = graph.size() > 0 ? "*" : "";
  if (auto selection = Selection::parse(text, graph)) show(text, std::move(*selection));
}

std::optional<StructureDraw> SelectionEditor::appearance(StructureIndex s) const {
  for (const StructureIndex d : graph_.descendants(s)) {
    if (drawable_[d] && is_on(selection_.structures[d])) return selection_.structures[d];
  }
  return std::nullopt;
}

StructureDraw SelectionEditor::switched_on(StructureIndex s) const {
  StructureDraw draw = selection_.structures[s];
  const DrawMode mode = draw.ghost ? DrawMode::kSurface : DrawMode::kVolume;
  if (!is_on(draw) || draw.ghost) draw = {.mode = mode, .opacity = std::nullopt, .color = graph_[s].color};
  return draw;
}

void SelectionEditor::set_mode(StructureIndex s, DrawMode mode) {
  Selection wanted = selection_;
  for (const StructureIndex d : graph_.descendants(s)) {
    StructureDraw draw = switched_on(d);
    draw.mode = mode;
    wanted.structures[d] = mode == DrawMode::kOff ? StructureDraw{} : draw;
  }
  commit(std::move(wanted));
}

/// Applies `edit` to the drawn structures of a subtree, as part of a gesture.
template <typename Edit>
void SelectionEditor::edit_drawn(Gesture gesture, const Edit& edit) {
  Selection wanted = selection_;
  for (const StructureIndex d : graph_.descendants(gesture.structure)) {
    if (is_on(wanted.structures[d])) edit(wanted.structures[d]);
  }
  commit(std::move(wanted), gesture);
}

void SelectionEditor::set_opacity(StructureIndex s, std::optional<float> opacity) {
  edit_drawn({s, 'o'}, [&](StructureDraw& draw) { draw.opacity = opacity; });
}

void SelectionEditor::set_color(StructureIndex s, Rgb color) {
  edit_drawn({s, 'c'}, [&](StructureDraw& draw) { draw.color = color; });
}

/// Switches a subtree on, with the other structures as given.
void SelectionEditor::show_among(StructureIndex s, Selection others) {
  for (const StructureIndex d : graph_.descendants(s)) others.structures[d] = switched_on(d);
  commit(std::move(others));
}

void SelectionEditor::isolate(StructureIndex s) {
  show_among(s, nothing());
}

void SelectionEditor::ghost_others(StructureIndex s) {
  Selection ghosts = selection_;
  for (StructureDraw& draw : ghosts.structures) {
    if (!is_on(draw)) continue;
    draw = {.mode = DrawMode::kSurface, .opacity = std::nullopt, .color = kGhostColor, .ghost = true};
  }
  show_among(s, std::move(ghosts));
}

void SelectionEditor::show_all() {
  Selection wanted;
  for (const Structure& structure : graph_.structures()) {
    wanted.structures.push_back(
        {.mode = DrawMode::kVolume, .opacity = std::nullopt, .color = structure.color});
  }
  commit(std::move(wanted));
}

void SelectionEditor::hide_all() {
  commit(nothing());
}

Selection SelectionEditor::nothing() const {
  Selection selection;
  selection.structures.resize(graph_.size());
  return selection;
}

Result<void> SelectionEditor::set_text(std::string_view text) {
  text = trimmed(text);
  Result<Selection> selection = Selection::parse(text, graph_);
  if (!selection) return tl::unexpected(std::move(selection).error());
  if (text == text_) return {};
  remember();
  gesture_ = {};
  show(std::string(text), *std::move(selection));
  return {};
}

void SelectionEditor::commit(Selection wanted, Gesture gesture) {
  if (draw_alike(wanted, selection_)) return;
  settle_groups(wanted);
  std::string text = to_text(wanted, graph_);
  auto selection = Selection::parse(text, graph_);  // generated text is always valid
  if (!selection || text == text_) return;
  const bool same_gesture = gesture.kind != 0 && gesture == gesture_;
  if (!same_gesture) remember();
  gesture_ = gesture;
  show(std::move(text), std::move(*selection));
}

/// Gives a group, which has no voxels or triangles, the settings that all its children share. The text then
/// names the group instead of each child.
void SelectionEditor::settle_groups(Selection& wanted) const {
  const auto order = graph_.topological();
  for (auto s = order.rbegin(); s != order.rend(); ++s) {
    const auto children = graph_.children(*s);
    if (drawable_[*s] || children.empty()) continue;
    const StructureDraw& first = wanted.structures[children.front()];
    const bool alike = std::all_of(children.begin(), children.end(), [&](StructureIndex child) {
      const StructureDraw& draw = wanted.structures[child];
      return alike_but_for_color(draw, first);
    });
    if (!alike) continue;
    StructureDraw& group = wanted.structures[*s];
    if (!is_on(first)) {
      group = {};
    } else if (!alike_but_for_color(group, first)) {
      group = first;
      if (!first.ghost) group.color = graph_[*s].color;
    }
  }
}

void SelectionEditor::remember() {
  undo_.push_back(text_);
  if (undo_.size() > kMaxUndoSteps) undo_.pop_front();
  redo_.clear();
}

void SelectionEditor::show(std::string text, Selection selection) {
  text_ = std::move(text);
  selection_ = std::move(selection);
  ++version_;
  modes_.assign(graph_.size(), {});
  const auto order = graph_.topological();
  for (auto s = order.rbegin(); s != order.rend(); ++s) {
    ModeSet& modes = modes_[*s];
    if (drawable_[*s]) modes.insert(selection_.structures[*s].mode);
    for (const StructureIndex child : graph_.children(*s)) modes.insert(modes_[child]);
  }
  for (StructureIndex s = 0; s < graph_.size(); ++s) {
    if (modes_[s].empty()) modes_[s].insert(selection_.structures[s].mode);
  }
}

void SelectionEditor::travel(std::deque<std::string>& from, std::deque<std::string>& to) {
  if (from.empty()) return;
  std::string text = std::move(from.back());
  from.pop_back();
  auto selection = Selection::parse(text, graph_);  // valid: it was selected before
  if (!selection) return;
  to.push_back(text_);
  gesture_ = {};
  show(std::move(text), std::move(*selection));
}

void SelectionEditor::undo() {
  travel(undo_, redo_);
}
void SelectionEditor::redo() {
  travel(redo_, undo_);
}

void SelectionEditor::revert_to(const std::string& text) {
  auto selection = Selection::parse(text, graph_);
  if (!selection) return;
  if (!undo_.empty() && undo_.back() == text) undo_.pop_back();
  gesture_ = {};
  show(text, std::move(*selection));
}

}  // namespace splatlas
