// libFuzzer entry point of mutate_atlas().
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/mutators.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  using namespace splatlas;
  const auto mutate_bytes = [](Bytes& bytes, std::size_t max_bytes) {
    const std::size_t size_before = bytes.size();
    bytes.resize(std::max<std::size_t>(max_bytes, 1));
    bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()),
                                  std::min(size_before, bytes.size()), bytes.size()));
  };
  Random random(seed);
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  const Bytes mutated = mutate_atlas({begin, begin + size}, max_size, random, mutate_bytes);
  if (mutated.size() > max_size) return size;
  std::memcpy(data, mutated.data(), mutated.size());
  return mutated.size();
}
