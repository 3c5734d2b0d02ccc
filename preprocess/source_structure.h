// A structure as an input file describes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "format/color.h"

namespace splatlas {

/// A structure as its source gives it, before the tree file places it. Its number in a list of these is its
/// source number.
struct SourceStructure {
  std::string name;
  std::optional<std::int64_t> label;
  std::optional<std::int64_t> code;
  std::optional<Rgb> color;
  bool external = false;
};

}  // namespace splatlas
