// Messages of notes.
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

}  // namespace splatlas
