// libFuzzer entry points. FUZZ_TARGET in the environment names the target.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mutators.h"
#include "tests/fuzz/require.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace splatlas {
namespace {

const FuzzTarget& chosen_target() {
  static const FuzzTarget* const kTarget = [] {
    const char* const name = std::getenv("FUZZ_TARGET");
    return find_target(name != nullptr ? name : "");
  }();
  require(kTarget != nullptr, "FUZZ_TARGET names no target");
  return *kTarget;
}

Bytes mutated_atlas(Bytes atlas, std::size_t max_size, Random& random) {
  const auto mutate_bytes = [](Bytes& bytes, std::size_t max_bytes) {
    const std::size_t size_before = bytes.size();
    bytes.resize(std::max<std::size_t>(max_bytes, 1));
    bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()),
                                  std::min(size_before, bytes.size()), bytes.size()));
  };
  return mutate_atlas(atlas, max_size, random, mutate_bytes);
}

}  // namespace
}  // namespace splatlas

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  using namespace splatlas;
  Random random(seed);
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  if (chosen_target().name() != "atlases") return LLVMFuzzerMutate(data, size, max_size);
  const Bytes mutated = mutated_atlas({begin, begin + size}, max_size, random);
  if (mutated.size() > max_size) return size;
  std::memcpy(data, mutated.data(), mutated.size());
  return mutated.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splatlas::chosen_target().run(data, size);
  return 0;
}
