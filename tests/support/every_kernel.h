// Fixture of kernel tests, once for every instruction set.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

namespace splatlas {

/// Stands for the scalar references among Highway's targets.
inline constexpr std::int64_t kScalarReference = 0;

/// Targets that the kernels are compiled for and that this machine runs.
inline std::vector<std::int64_t> kernel_targets() {
  std::vector<std::int64_t> targets;
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1)
    targets.push_back(rest & -rest);
  return targets;
}

/// The same without Highway's scalar target, for kernels whose scalar reference is just that.
inline std::vector<std::int64_t> simd_targets() {
  std::vector<std::int64_t> targets = kernel_targets();
  std::erase(targets, std::int64_t{HWY_SCALAR});
  return targets;
}

/// The scalar references, too.
inline std::vector<std::int64_t> targets_and_reference() {
  std::vector<std::int64_t> targets = kernel_targets();
  targets.push_back(kScalarReference);
  return targets;
}

inline std::string kernel_name(const testing::TestParamInfo<std::int64_t>& target) {
  return target.param == kScalarReference ? "ScalarReference" : hwy::TargetName(target.param);
}

/// Restricts dispatch to one target while a test runs.
class EveryKernel : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { dispatch_to(GetParam()); }
  void TearDown() override { dispatch_to(0); }

  [[nodiscard]] static bool is_reference() { return GetParam() == kScalarReference; }

 private:
  /// 0: no restriction.
  static void dispatch_to(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

}  // namespace splatlas
