#include "bench/decoded_selection.h"

#include <vector>

namespace splatlas {

Result<DecodedSelection> decode_selection(const std::shared_ptr<const Atlas>& atlas,
                                          const Selection& selection, Axis axis, ThreadPool& pool) {
  DecodedSelection decoded{atlas->tree().plan(selection),
                           std::make_unique<ClassCache>(atlas),
                           std::make_unique<VolumeLooks>(*atlas),
                           {}};
  decoded.looks->select(decoded.plan, selection);
  std::vector<ClassId> classes;
  for (const ClassDraw& draw : decoded.plan.classes) {
    if (draws_volume(draw.role)) classes.push_back(draw.id);
  }
  SPLATLAS_RETURN_IF_ERROR(decoded.cache->require(classes, axis, pool));
  decoded.runs = std::make_unique<SelectedRuns>(decoded.plan, atlas->classes(), *decoded.cache, axis);
  return decoded;
}

}  // namespace splatlas
