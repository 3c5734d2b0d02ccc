// Notes of an import: what is odd about its files, one line a kind.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace splatlas {

/// A kind of notes. `one` and `many` follow the count: "mask without voxels is dropped". Both are empty if
/// items are whole sentences.
struct NoteKind {
  std::string id;  ///< stable, for --json: "empty-masks"
  std::string one, many;
  bool is_warning = false;  ///< may be a fault of the files: --strict stops at it
  bool is_minor = false;    ///< for reports only: nobody misses it on a terminal

  friend bool operator==(const NoteKind&, const NoteKind&) = default;
};

/// All notes of one kind.
struct Note {
  NoteKind kind;
  std::vector<std::string> items;  ///< one per case: a file, a structure, a label

  /// "77 masks without voxels are dropped: adrenal_left, aorta, brain and 74 more".
  [[nodiscard]] std::string message() const;
};

/// Notes by kind, in the order of the first case.
class Notes {
 public:
  void add(const NoteKind& kind, std::string item);
  void add(const Notes& others);
  [[nodiscard]] std::span<const Note> all() const { return notes_; }
  [[nodiscard]] bool empty() const { return notes_.empty(); }
  friend void transfer(auto& archive, Notes& notes) { archive(notes.notes_); }

 private:
  std::vector<Note> notes_;
};

}  // namespace splatlas
