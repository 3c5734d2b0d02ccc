// Structure of a source, before its placement in the graph.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "format/color.h"

namespace splatlas {

/// A structure before its placement in the graph. Its index in the list of these is its source number.
struct SourceStructure {
  std::string name;
  std::optional<std::int64_t> label;
  std::optional<std::int64_t> code;  ///< AAL's third column, a hierarchical region code
  std::optional<Rgb> color;
  bool external = false;
};

}  // namespace splatlas
