#include "player/render/simd/simd_choice.h"

#include <string>

#include <gtest/gtest.h>

#include "player/render/rays/march_kernels.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/sheets/warp/warp_kernels.h"

namespace splatlas {
namespace {

/// Chooses the kernels with SPLATLAS_SIMD set to `name`, and exits with 0 if dispatch then runs `target`.
[[noreturn]] void exit_after_choice(const std::string& name, std::string_view target) {
  setenv("SPLATLAS_SIMD", name.c_str(), 1);
  const bool is_available = simd_is_available();
  for (const char* const chosen : {best_march().name, best_kernels().name, best_warp().name})
    if (chosen != target) std::exit(1);
  std::exit(is_available && simd_is_available() && target == dispatched_target() ? 0 : 2);
}

TEST(SimdChoiceDeathTest, RunsTheForcedInstructionSet) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // in a process of its own: the choice is made once
  for (const auto& [name, target] : kSimdNames) {
    if ((supported_targets() & HWY_TARGETS & target) == 0) continue;
    SCOPED_TRACE(name);
    EXPECT_EXIT(exit_after_choice(std::string(name), hwy::TargetName(target)), testing::ExitedWithCode(0),
                "");
  }
}

}  // namespace
}  // namespace splatlas
