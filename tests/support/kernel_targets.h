// Instruction sets of the kernels.
#pragma once

#include <cstdint>
#include <vector>

#include <hwy/highway.h>
#include <hwy/targets.h>

namespace splatlas {

/// Targets that the kernels are compiled for and that this machine runs.
inline std::vector<std::int64_t> kernel_targets() {
  std::vector<std::int64_t> targets;
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1)
    targets.push_back(rest & -rest);
  return targets;
}

/// Restricts dispatch to one target during its lifetime. 0: no restriction.
class DispatchTo {
 public:
  explicit DispatchTo(std::int64_t target) { restrict_to(target); }
  ~DispatchTo() { restrict_to(0); }
  DispatchTo(const DispatchTo&) = delete;
  DispatchTo& operator=(const DispatchTo&) = delete;

 private:
  static void restrict_to(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

}  // namespace splatlas
