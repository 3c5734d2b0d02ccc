#include "format/selection/glob.h"

#include "format/text/ascii_text.h"

namespace splatlas {

Glob::Glob(std::string_view pattern) : pattern_(to_lower(pattern)) {}

Glob::States Glob::start() const {
  States states = none();
  states[0] = 1;
  skip_stars(states);
  return states;
}

Glob::States Glob::read(States states, std::string_view text) const {
  States next;
  for (const char c : text) {
    next.assign(states.size(), 0);
    for (std::size_t n = 0; n < pattern_.size(); ++n) {
      if (states[n] == 0) continue;
      if (pattern_[n] == '*') next[n] = 1;
      if (pattern_[n] == to_lower(c)) next[n + 1] = 1;
    }
    skip_stars(next);
    states.swap(next);
  }
  return states;
}

void Glob::skip_stars(States& states) const {
  for (std::size_t n = 0; n < pattern_.size(); ++n) {
    if (states[n] != 0 && pattern_[n] == '*') states[n + 1] = 1;
  }
}

void Glob::merge(const States& from, States& into) {
  for (std::size_t n = 0; n < into.size(); ++n) into[n] |= from[n];
}

}  // namespace splatlas
