#include "player/missing_parts.h"

#include <fmt/format.h>

#include "format/text/ascii_text.h"

namespace splatlas {

std::string describe(const MissingPart& missing, const StructureGraph& graph) {
  const std::string what = missing.surface ? "surface" : fmt::format("volume of {} voxels", missing.voxels);
  return fmt::format("{}: its {} is missing: {}", in_quotes(graph[missing.structure].id), what,
                     missing.error.message);
}

}  // namespace splatlas
