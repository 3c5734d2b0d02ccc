// Notes of an import: what is odd about its files, one line a kind.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace splatlas {

enum class NoteLevel : std::uint8_t {
  kMinor,  ///< for reports only: nobody misses it on a terminal
  kNote,
  kWarning,  ///< may be a fault of the files: --strict stops at it
};

/// All notes of one kind.
struct Note {
  std::string kind;                ///< of notes.txt; stable, for --json: "empty-masks"
  std::vector<std::string> items;  ///< one per case: a file, a structure, a label

  [[nodiscard]] NoteLevel level() const;
  /// "77 masks without voxels are dropped: adrenal_left, aorta, brain and 74 more".
  [[nodiscard]] std::string message() const;
};

/// Notes by kind, in the order of the first case.
class Notes {
 public:
  void add(std::string_view kind, std::string item);
  void add(const Notes& others);
  [[nodiscard]] std::span<const Note> all() const { return notes_; }
  [[nodiscard]] bool empty() const { return notes_.empty(); }
  friend void transfer(auto& archive, Notes& notes) { archive(notes.notes_); }

 private:
  std::vector<Note> notes_;
};

}  // namespace splatlas
