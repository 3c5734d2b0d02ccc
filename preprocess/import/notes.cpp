#include "preprocess/import/notes.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

/// Level, kind, and the phrases behind the counts one and many, a line each. Items of kinds without phrases
/// are whole sentences.
constexpr std::string_view kNotes =
#include "preprocess/import/notes.txt"
    ;

struct Phrases {
  NoteLevel level = NoteLevel::kNote;
  std::string_view one = "", many = "";
};

Phrases phrases_of(std::string_view kind) {
  static const std::map<std::string_view, Phrases> kPhrases = [] {
    std::map<std::string_view, Phrases> phrases;
    for (const std::string_view line : split(kNotes, '\n')) {
      const std::vector<std::string_view> parts = split(line, '|');
      Phrases& known = phrases[parts[1]];
      if (parts[0] != "note") known.level = parts[0] == "warning" ? NoteLevel::kWarning : NoteLevel::kMinor;
      if (parts.size() > 3) known.one = parts[2], known.many = parts[3];
    }
    return phrases;
  }();
  const auto found = kPhrases.find(kind);
  return found == kPhrases.end() ? Phrases() : found->second;
}

}  // namespace

NoteLevel Note::level() const {
  return phrases_of(kind).level;
}

std::string Note::message() const {
  constexpr std::size_t kMaxListed = 3;
  const Phrases phrases = phrases_of(kind);
  const std::span listed = std::span(items).first(std::min(items.size(), kMaxListed));
  if (phrases.one.empty()) return fmt::format("{}", fmt::join(items, "; "));
  std::string text = fmt::format("{} {}: {}", items.size(), items.size() == 1 ? phrases.one : phrases.many,
                                 fmt::join(listed, ", "));
  if (items.size() > kMaxListed) text += fmt::format(" and {} more", items.size() - kMaxListed);
  return text;
}

void Notes::add(std::string_view kind, std::string item) {
  const auto found = std::ranges::find(notes_, kind, &Note::kind);
  Note& note = found == notes_.end() ? notes_.emplace_back(Note{std::string(kind), {}}) : *found;
  note.items.push_back(std::move(item));
}

void Notes::add(const Notes& others) {
  for (const Note& note : others.notes_) {
    for (const std::string& item : note.items) add(note.kind, item);
  }
}

}  // namespace splatlas
