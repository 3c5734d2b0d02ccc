// Choice of the instruction set of the kernels.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <hwy/highway.h>
#include <hwy/targets.h>

namespace splatlas {

/// SPLATLAS_SIMD in the environment, for comparisons: "scalar" forces the scalar reference kernels; "sse4",
/// "avx2" and "avx512" (or "avx3") these instruction sets, where the machine has them; others are ignored.
inline std::string_view forced_simd() {
  const char* const forced = std::getenv("SPLATLAS_SIMD");
  return forced != nullptr ? forced : "";
}

inline bool scalar_is_forced() {
  return forced_simd() == "scalar";
}

/// Instruction sets by their names. The build has those of SPLATLAS_SIMD (cmake/SplatlasSetup.cmake).
inline constexpr std::array<std::pair<std::string_view, std::int64_t>, 4> kSimdNames{
    {{"sse4", HWY_SSE4}, {"avx2", HWY_AVX2}, {"avx512", HWY_AVX3}, {"avx3", HWY_AVX3}}};

/// Instruction sets of the machine, without those that a forced one excludes. Keeps the choice of the
/// dispatch: hwy::SupportedTargets() alone resets it to all sets that the machine has.
[[nodiscard]] std::int64_t supported_targets();

/// True unless SPLATLAS_SIMD names an instruction set that is unknown, or that machine or build lack.
inline bool simd_is_available() {
  if (forced_simd().empty() || scalar_is_forced()) return true;
  return std::ranges::any_of(kSimdNames, [](const auto& simd) {
    return simd.first == forced_simd() && (supported_targets() & HWY_TARGETS & simd.second) != 0;
  });
}

/// The name of the instruction set that kernels are dispatched to. Applies SPLATLAS_SIMD, once.
[[nodiscard]] const char* best_target();

/// The name of the instruction set that dispatch runs now, told by code compiled for it.
[[nodiscard]] const char* dispatched_target();

}  // namespace splatlas
