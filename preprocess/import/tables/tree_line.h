// A line of a hierarchy, before names are resolved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/content/color.h"

namespace splatlas {

/// Colours interpolated linearly over the structures of a line; both are equal for a single colour.
struct ColorRange {
  Rgb first, last;
};

/// A structure or group of a table or JSON file, known by a key of its own.
struct TreeNode {
  std::string key;  ///< unique in the file
  std::string name;
  std::optional<std::int64_t> label;  ///< identifies the structure; else its name does
  std::vector<std::string> parents;   ///< keys; empty for a root
};

/// One line of a tree: a path of a tree file, or a node.
struct TreeLine {
  std::size_t number = 0;           ///< line or entry of the file, from 1
  std::vector<std::string> groups;  ///< from the root
  std::string member;               ///< structure, pattern, "code:...", "#17" or group; empty for groups only
  std::optional<ColorRange> color;
  std::optional<TreeNode> node;  ///< replaces groups and member
};

}  // namespace splatlas
