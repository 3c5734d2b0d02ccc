// Structure of a source, before its placement in the graph.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/structure_graph.h"

namespace splatlas {

using SourceTerm = Term;

/// The vocabulary of a coding scheme of DICOM: "SNOMED" for SCT, else the scheme itself.
[[nodiscard]] inline std::string vocabulary_of(std::string_view scheme) {
  return scheme == "SCT" ? "SNOMED" : std::string(scheme);
}

/// A structure before its placement in the graph. Its index in the list of these is its source number.
struct SourceStructure {
  std::string name;
  std::optional<std::int64_t> label;
  std::optional<std::int64_t> code;  ///< AAL's third column, a hierarchical region code
  std::optional<Rgb> color;
  bool external = false;
  std::vector<SourceTerm> terms;  ///< in the order of the source
};

}  // namespace splatlas
