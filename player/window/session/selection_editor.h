// Editor of a selection by subtree or by text, with undo.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/content/selection.h"
#include "format/content/structure_graph.h"

namespace splatlas {

/// Set of the draw modes in a subtree.
class ModeSet {
 public:
  void insert(DrawMode mode) { bits_ = static_cast<std::uint8_t>(bits_ | bit(mode)); }
  void insert(ModeSet other) { bits_ = static_cast<std::uint8_t>(bits_ | other.bits_); }
  [[nodiscard]] bool empty() const { return bits_ == 0; }
  [[nodiscard]] bool contains(DrawMode mode) const { return (bits_ & bit(mode)) != 0; }
  /// True if the set is {mode}.
  [[nodiscard]] bool is_only(DrawMode mode) const { return bits_ == bit(mode); }

 private:
  static constexpr std::uint8_t bit(DrawMode mode) {
    return static_cast<std::uint8_t>(1u << static_cast<unsigned>(mode));
  }
  std::uint8_t bits_ = 0;
};

/// A selection and its text. Invariant: selection() == Selection::parse(text()), including term numbers. Not
/// thread-safe.
class SelectionEditor {
 public:
  /// Starts with "*": all structures as volumes. `drawable[s]`: structure `s` has voxels or triangles of its
  /// own; otherwise it is a group. `graph` must outlive the editor.
  SelectionEditor(const StructureGraph& graph, std::vector<bool> drawable);

  [[nodiscard]] const Selection& selection() const { return selection_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// Counter of changes of the selection.
  [[nodiscard]] std::uint64_t version() const { return version_; }

  /// Modes of the drawable structures in the subtree of `s`; the mode of `s` if none is drawable.
  [[nodiscard]] ModeSet modes(StructureIndex s) const { return modes_[s]; }
  /// Settings of the first drawn structure of the subtree, as initial values of an edit; none if all are off.
  [[nodiscard]] std::optional<StructureDraw> appearance(StructureIndex s) const;

  // All edits apply to the whole subtree of `s`, and to the same structures below other parents.

  /// Sets the mode. Keeps opacities and colours of structures that were on.
  void set_mode(StructureIndex s, DrawMode mode);
  /// Sets the opacity of drawn structures; none: the default of the mode. Consecutive calls of one
  /// setter for one structure are one undo step until end_gesture().
  void set_opacity(StructureIndex s, std::optional<float> opacity);
  void set_color(StructureIndex s, Rgb color);
  void end_gesture() { gesture_ = {}; }

  /// Draws this subtree only. Structures that were off become volumes.
  void isolate(StructureIndex s);
  /// As isolate(), but other structures that were on become one grey hull.
  void ghost_others(StructureIndex s);
  void show_all();
  void hide_all();

  /// Sets the selection from text, and keeps the text except for blanks at its ends. kUsage or kNotFound,
  /// with the old selection, for invalid text.
  [[nodiscard]] Result<void> set_text(std::string_view text);

  [[nodiscard]] bool can_undo() const { return !undo_.empty(); }
  [[nodiscard]] bool can_redo() const { return !redo_.empty(); }
  void undo();
  void redo();
  /// Returns to an earlier text and removes the later one from the history. For selections that cannot be
  /// rendered.
  void revert_to(const std::string& text);

 private:
  struct Gesture {
    StructureIndex structure = kNoStructure;
    char kind = 0;
    friend bool operator==(const Gesture&, const Gesture&) = default;
  };

  [[nodiscard]] Selection nothing() const;
  [[nodiscard]] StructureDraw switched_on(StructureIndex s) const;
  void show_among(StructureIndex s, Selection others);
  template <typename Edit>
  void edit_drawn(Gesture gesture, const Edit& edit);
  void commit(Selection wanted) { commit(std::move(wanted), Gesture()); }
  void commit(Selection wanted, Gesture gesture);
  void settle_groups(Selection& wanted) const;
  void remember();
  void show(std::string text, Selection selection);
  void travel(std::deque<std::string>& from, std::deque<std::string>& to);

  const StructureGraph& graph_;
  std::vector<bool> drawable_;
  Selection selection_;
  std::string text_;
  std::vector<ModeSet> modes_;
  std::uint64_t version_ = 0;
  Gesture gesture_;
  std::deque<std::string> undo_, redo_;  // texts, newest last
};

}  // namespace splatlas
