// Tree files: how structures belong together.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/color.h"
#include "format/result.h"

namespace splatlas {

/// The form of a tree file, for --help and for the top of tree files.
inline constexpr const char* kTreeFormat =
    R"(One path per line, parts joined by "/":
  Brain/Left hemisphere/Precentral_L     a structure below two groups
  Brain/Frontal lobe/Precentral_L        ... and below another group as well: it then has two parents
  Brain/Left hemisphere/*_L              every structure whose name or id fits the pattern
  Brain/Frontal lobe/code:2001-2999      every structure with such a code in the names file (also 9100,9110)
  Brain/Left cerebrum/code:2001-8999&*_L  every structure that fits both
  Brain/Cerebellum/                      a group, though nothing may be below it
The last part names structures; the parts before it name groups, made when first used. A group is known by its
name: written again elsewhere, also as a last part, it is the same group with one more parent. Case does not
matter. Structures are numbered in the order of the file; those that it does not mention become roots.
" color=#rrggbb" at the end colours what the last part names; "color=#rrggbb-#rrggbb" spreads from one colour
to the other over several. Blank lines and lines that start with "#" do not count.)";

/// From one colour to the other over the structures of a line; both equal for a single colour.
struct ColorRange {
  Rgb first, last;
};

struct TreeLine {
  std::size_t number = 0;
  std::vector<std::string> groups;  ///< from the root
  std::string member;               ///< structure, pattern, "code:..." or group; empty: the groups alone
  std::optional<ColorRange> color;
};

/// Syntax only; kFailed names file and line of the first fault.
[[nodiscard]] Result<std::vector<TreeLine>> read_tree(const std::filesystem::path& path);

}  // namespace splatlas
