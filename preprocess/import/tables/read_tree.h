// Reader of tree files, which define the hierarchy of structures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/color.h"
#include "format/result.h"

namespace splatlas {

/// Description of the tree file format, for --help and for the head of tree files.
inline constexpr const char* kTreeFormat =
    R"(One path per line, parts joined by "/":
  Brain/Left hemisphere/Precentral_L     a structure below two groups
  Brain/Frontal lobe/Precentral_L        ... and below another group: it then has two parents
  Brain/Left hemisphere/*_L              all structures with a matching name or id
  Brain/Frontal lobe/code:2001-2999      all structures with such a code in the names file (also 9100,9110)
  Brain/Left cerebrum/code:2001-8999&*_L  all structures that match both
  Brain/Cerebellum/                      a group, possibly empty
The last part selects structures. The other parts are groups, created at first use and identified by name: a group
in several places has several parents. Case is ignored. Structures are numbered in the order of the file; structures
that are not mentioned become roots.
" color=#rrggbb" at the end sets the colour of the last part; "color=#rrggbb-#rrggbb" interpolates between two
colours over several structures. Blank lines and lines that start with "#" are ignored.)";

/// Colours interpolated linearly over the structures of a line; both are equal for a single colour.
struct ColorRange {
  Rgb first, last;
};

/// One parsed line of a tree file.
struct TreeLine {
  std::size_t number = 0;
  std::vector<std::string> groups;  ///< from the root
  std::string member;               ///< structure, pattern, "code:..." or group; empty for groups only
  std::optional<ColorRange> color;
};

/// Parses a tree file without resolving names. kFailed with file and line of the first fault.
[[nodiscard]] Result<std::vector<TreeLine>> read_tree(const std::filesystem::path& path);

}  // namespace splatlas
