// Patterns with "*".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace splatlas {

/// A pattern in which "*" stands for any characters, none and "/" included. The case of ASCII letters does
/// not count. Works as an automaton, so that a text can be read piece by piece: no backtracking, and several
/// texts with a common end can be read together.
class Glob {
 public:
  /// Per position in the pattern: can it be reached by what was read so far?
  using States = std::vector<std::uint8_t>;

  explicit Glob(std::string_view pattern);

  [[nodiscard]] States start() const;
  [[nodiscard]] States none() const { return States(pattern_.size() + 1, 0); }
  /// Cost: length of the text times length of the pattern.
  [[nodiscard]] States read(States states, std::string_view text) const;
  [[nodiscard]] bool accepts(const States& states) const { return states.back() != 0; }
  /// The whole text.
  [[nodiscard]] bool matches(std::string_view text) const { return accepts(read(start(), text)); }

  /// Adds the states in `from` to `into`.
  static void merge(const States& from, States& into);

 private:
  /// A "*" may stand for nothing.
  void skip_stars(States& states) const;

  std::string pattern_;  // lowered
};

}  // namespace splatlas
