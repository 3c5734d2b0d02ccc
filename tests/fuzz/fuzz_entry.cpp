// libFuzzer entry point of a fuzz target.
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splatlas::fuzz({data, size});
  return 0;
}
