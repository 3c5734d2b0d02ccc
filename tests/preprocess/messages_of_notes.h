// Messages and items of notes.
#pragma once

#include <string>
#include <vector>

#include "preprocess/import/notes.h"

namespace splatlas {

inline std::vector<std::string> messages_of(const Notes& notes) {
  std::vector<std::string> messages;
  for (const Note& note : notes.all()) messages.push_back(note.message());
  return messages;
}

/// Items of the notes of a kind.
inline std::vector<std::string> items_of(const Notes& notes, const std::string& kind) {
  for (const Note& note : notes.all()) {
    if (note.kind == kind) return note.items;
  }
  return {};
}

}  // namespace splatlas
