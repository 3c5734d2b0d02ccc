// Test fixture that runs a kernel test on every instruction set.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

namespace splatlas {

/// The scalar reference kernels, among the targets of Highway.
inline constexpr std::int64_t kScalarReference = 0;

/// The compiled targets that this machine supports.
inline std::vector<std::int64_t> kernel_targets() {
  std::vector<std::int64_t> targets;
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1)
    targets.push_back(rest & -rest);
  return targets;
}

/// kernel_targets() and the scalar reference.
inline std::vector<std::int64_t> targets_and_reference() {
  std::vector<std::int64_t> targets = kernel_targets();
  targets.push_back(kScalarReference);
  return targets;
}

inline std::string kernel_name(const testing::TestParamInfo<std::int64_t>& target) {
  return target.param == kScalarReference ? "Scalar" : hwy::TargetName(target.param);
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
