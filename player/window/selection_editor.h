// The selection as the window edits it: modes by subtree, and the same as text.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/selection.h"
#include "format/structure_graph.h"

namespace splatlas {

/// The modes that occur among the drawable structures of a subtree.
class ModeSet {
 public:
  void insert(DrawMode mode) { bits_ = static_cast<std::uint8_t>(bits_ | bit(mode)); }
  void insert(ModeSet other) { bits_ = static_cast<std::uint8_t>(bits_ | other.bits_); }
  [[nodiscard]] bool empty() const { return bits_ == 0; }
  [[nodiscard]] bool contains(DrawMode mode) const { return (bits_ & bit(mode)) != 0; }
  /// `mode` and no other.
  [[nodiscard]] bool is_only(DrawMode mode) const { return bits_ == bit(mode); }

 private:
  static constexpr std::uint8_t bit(DrawMode mode) {
    return static_cast<std::uint8_t>(1u << static_cast<unsigned>(mode));
  }
  std::uint8_t bits_ = 0;
};

/// Opacity of the surfaces around the structure that "ghost the others" keeps.
inline constexpr float kGhostOpacity = 0.08f;

/// A selection with its text. Both always say the same: what is drawn is what select(text()) gives, term
/// numbers included. Not for use by several threads at once.
class SelectionEditor {
 public:
  /// Begins with everything as volume, "*". `drawable[s]`: structure `s` has voxels or triangles of its own,
  /// it is no mere group. `graph` must outlive the editor.
  SelectionEditor(const StructureGraph& graph, std::vector<bool> drawable);

  [[nodiscard]] const Selection& selection() const { return selection_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// Goes up with every change: compare to see whether the selection is another one.
  [[nodiscard]] std::uint64_t version() const { return version_; }

  /// Modes among the drawable structures of `s` and its descendants; of `s` itself when none is drawable.
  [[nodiscard]] ModeSet modes(StructureIndex s) const { return modes_[s]; }
  /// The looks of the first drawn structure of the subtree, to start an edit from; none when all are off.
  [[nodiscard]] std::optional<StructureDraw> appearance(StructureIndex s) const;

  // All edits reach the whole subtree of `s`, and the same structures under their other parents.

  /// Keeps opacities and colours of structures that were on.
  void set_mode(StructureIndex s, DrawMode mode);
  /// Of those that are on; none: back to the default of the mode. Consecutive calls for one structure are one
  /// step of undo until end_gesture().
  void set_opacity(StructureIndex s, std::optional<float> opacity);
  void set_color(StructureIndex s, Rgb color);
  void end_gesture() { gesture_ = {}; }

  /// Only this subtree, as it was; as volume what was off.
  void isolate(StructureIndex s);
  /// This subtree as isolate() has it, everything else that was on as a faint surface.
  void ghost_others(StructureIndex s);
  void show_all();
  void hide_all();

  /// The user's own words, kept as typed (but for blanks at the ends). kUsage or kNotFound when they cannot
  /// be understood; the selection then stays.
  [[nodiscard]] Result<void> set_text(std::string_view text);

  [[nodiscard]] bool can_undo() const { return !undo_.empty(); }
  [[nodiscard]] bool can_redo() const { return !redo_.empty(); }
  void undo();
  void redo();
  /// Goes back to a text that was shown before, without a trace in the history: for selections that turned
  /// out not to be renderable.
  void give_up_for(const std::string& text);

 private:
  struct Gesture {
    StructureIndex structure = kNoStructure;
    char kind = 0;
    friend bool operator==(const Gesture&, const Gesture&) = default;
  };

  [[nodiscard]] StructureDraw switched_on(StructureIndex s) const;
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
  std::deque<std::string> undo_, redo_;  // texts, the latest last
};

}  // namespace splatlas
