#include "tests/fuzz/fuzz_target.h"

#include <vector>

namespace splatlas {
namespace {

std::vector<FuzzTarget>& all_targets() {
  static std::vector<FuzzTarget> targets;
  return targets;
}

}  // namespace

FuzzTarget::FuzzTarget(std::string_view name, void (*fuzz)(FuzzInput), const InputLimit& limit)
    : name_(name), fuzz_(fuzz), limit_(limit) {
  all_targets().push_back(*this);
}

void FuzzTarget::run(const std::uint8_t* data, std::size_t size) const {
  const CostLimit limit(limit_.of(size), "the input");
  fuzz_({data, size});
}

const FuzzTarget* find_target(std::string_view name) {
  const auto found = std::ranges::find(all_targets(), name, &FuzzTarget::name);
  return found == all_targets().end() ? nullptr : &*found;
}

}  // namespace splatlas
