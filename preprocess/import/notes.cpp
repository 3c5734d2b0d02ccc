#include "preprocess/import/notes.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace splatlas {

std::string Note::message() const {
  constexpr std::size_t kMaxListed = 3;
  const std::span listed = std::span(items).first(std::min(items.size(), kMaxListed));
  if (kind.one.empty()) return fmt::format("{}", fmt::join(items, "; "));
  std::string text = fmt::format("{} {}: {}", items.size(), items.size() == 1 ? kind.one : kind.many,
                                 fmt::join(listed, ", "));
  if (items.size() > kMaxListed) text += fmt::format(" and {} more", items.size() - kMaxListed);
  return text;
}

void Notes::add(const NoteKind& kind, std::string item) {
  const auto found = std::ranges::find(notes_, kind.id, [](const Note& note) { return note.kind.id; });
  Note& note = found == notes_.end() ? notes_.emplace_back(Note{kind, {}}) : *found;
  note.items.push_back(std::move(item));
}

void Notes::add(const Notes& others) {
  for (const Note& note : others.notes_) {
    for (const std::string& item : note.items) add(note.kind, item);
  }
}

}  // namespace splatlas
