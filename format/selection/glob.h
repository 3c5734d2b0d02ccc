// Wildcard matching as a nondeterministic finite automaton.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace splatlas {

/// A pattern in which "*" matches any characters, including none and "/". Ignores the case of ASCII letters.
/// The automaton reads text in pieces, without backtracking, texts with a common suffix together.
class Glob {
 public:
  /// Active states of the automaton, one flag per position in the pattern.
  using States = std::vector<std::uint8_t>;

  explicit Glob(std::string_view pattern);

  [[nodiscard]] States start() const;
  [[nodiscard]] States none() const { return States(pattern_.size() + 1, 0); }
  /// Cost: length of the text times length of the pattern.
  [[nodiscard]] States read(States states, std::string_view text) const;
  [[nodiscard]] bool accepts(const States& states) const { return states.back() != 0; }
  /// True if the pattern matches the whole text.
  [[nodiscard]] bool matches(std::string_view text) const { return accepts(read(start(), text)); }

  /// Adds the states in `from` to `into`.
  static void merge(const States& from, States& into);

 private:
  /// Epsilon transitions: "*" matches the empty string.
  void skip_stars(States& states) const;

  std::string pattern_;  // lower case
};

}  // namespace splatlas
