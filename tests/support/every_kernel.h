// Fixture of kernel tests, once for every instruction set.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "tests/support/kernel_targets.h"

namespace splatlas {

/// Stands for the scalar references among Highway's targets.
inline constexpr std::int64_t kScalarReference = 0;

/// kernel_targets() and the scalar references.
inline std::vector<std::int64_t> targets_and_reference() {
  std::vector<std::int64_t> targets = kernel_targets();
  targets.push_back(kScalarReference);
  return targets;
}

inline std::string kernel_name(const testing::TestParamInfo<std::int64_t>& target) {
  return target.param == kScalarReference ? "ScalarReference" : hwy::TargetName(target.param);
}

class EveryKernel : public testing::TestWithParam<std::int64_t> {
 protected:
  [[nodiscard]] static bool is_reference() { return GetParam() == kScalarReference; }

 private:
  DispatchTo dispatch_{GetParam()};
};

}  // namespace splatlas
