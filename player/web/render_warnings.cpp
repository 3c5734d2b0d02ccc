#include "player/web/render_warnings.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "format/result_macros.h"

namespace splatlas {

Result<std::vector<std::string>> selection_warnings(std::span<const SelectionTerm> terms,
                                                    const Atlas& atlas) {
  constexpr std::size_t kMaxWarnings = 5;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<HiddenTerm> hidden, find_hidden_terms(terms, atlas.graph()));
  std::vector<std::string> warnings;
  for (const HiddenTerm& term : std::span(hidden).first(std::min(hidden.size(), kMaxWarnings))) {
    warnings.push_back(term.message);
  }
  if (hidden.size() > kMaxWarnings) {
    warnings.push_back(fmt::format("selection: {} more terms are hidden", hidden.size() - kMaxWarnings));
  }
  return warnings;
}

std::string emptiness_of(const Frame& frame) {
  const std::vector<float>& rgba = frame.picture.rgba;
  for (std::size_t n = 3; n < rgba.size(); n += 4) {
    if (rgba[n] > 0) return {};
  }
  const RenderStats& stats = frame.stats;
  if (stats.volume_voxels + stats.surface_voxels + stats.hybrid_voxels == 0 && stats.triangles == 0)
    return "the picture shows nothing: the selection is empty";
  return "the picture shows nothing of the selection: it is transparent, removed by a cut or beside the "
         "picture";
}

}  // namespace splatlas
