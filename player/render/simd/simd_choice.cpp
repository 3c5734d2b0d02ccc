// Choice of the instruction set. Highway compiles the report of what is run once for each set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/simd/simd_choice.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

const char* TargetDispatched() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/render/simd/simd_choice.h"

namespace splatlas {
namespace {

HWY_EXPORT(TargetDispatched);

/// Applies SPLATLAS_SIMD to the dispatch.
bool apply_forced_simd() {
  for (const auto& [name, target] : kSimdNames) {
    if (forced_simd() != name || (supported_targets() & target) == 0) continue;
    hwy::DisableTargets(target - 1);  // better targets are lower bits
  }
  static_cast<void>(supported_targets());  // chooses among the rest
  return true;
}

}  // namespace

std::int64_t supported_targets() {
  std::int64_t targets = hwy::SupportedTargets();
#if HWY_ARCH_X86
  if (__builtin_cpu_supports("sse4.2")) targets |= HWY_SSE4;  // Highway asks for AES, too
#endif
  hwy::GetChosenTarget().Update(targets);
  return targets;
}

const char* dispatched_target() {
  return HWY_DYNAMIC_DISPATCH(TargetDispatched)();
}

const char* best_target() {
  static const bool kApplied = apply_forced_simd();
  static_cast<void>(kApplied);
  return dispatched_target();
}

}  // namespace splatlas
#endif  // HWY_ONCE
