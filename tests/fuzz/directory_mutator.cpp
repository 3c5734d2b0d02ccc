// libFuzzer entry point of mutate_directory().
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/fuzz/mutators.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  using namespace splatlas;
  Random random(seed);
  if (below(2, random) == 0) return LLVMFuzzerMutate(data, size, max_size);
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  auto directory = decode_directory(std::vector<std::byte>(begin, begin + size));
  if (!directory || directory->normals_fitted.size() != directory->classes.size())
    return LLVMFuzzerMutate(data, size, max_size);
  mutate_directory(*directory, random);
  const auto mutated = encode_directory(*directory);
  if (!mutated || mutated->size() > max_size) return size;
  std::memcpy(data, mutated->data(), mutated->size());
  return mutated->size();
}
