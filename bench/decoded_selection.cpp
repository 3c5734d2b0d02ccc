#include "bench/decoded_selection.h"

#include "format/system/result_macros.h"

namespace splatlas {

Result<DecodedSelection> decode_selection(const std::shared_ptr<const Atlas>& atlas,
                                          const Selection& selection, Axis axis, ThreadPool& pool) {
  DecodedSelection decoded{atlas->tree().plan(selection),
                           std::make_unique<ClassCache>(atlas),
                           std::make_unique<VolumeAppearances>(*atlas),
                           {}};
  decoded.appearances->select(decoded.plan, selection);
  SPLATLAS_RETURN_IF_ERROR(decoded.cache->require(volume_classes(decoded.plan), axis, pool));
  decoded.runs = std::make_unique<SelectedRuns>(decoded.plan, atlas->classes(), *decoded.cache, axis);
  return decoded;
}

}  // namespace splatlas
