// libFuzzer entry point of a fuzz target, within its limit.
#include "tests/fuzz/cost_limit.h"
#include "tests/fuzz/fuzz_input.h"

namespace splatlas {

/// The seeds take at most 4 ms and 1.2 MiB. A quarter of a second allows for page faults and for tables that
/// are built at first use; 50 us per byte are 0.4 s for the longest input of scripts/fuzz.sh (8 KiB). Deflate
/// expands a byte to at most 1032, and a reader holds the bytes up to four times while it converts them:
/// 4 KiB per byte.
__attribute__((weak)) InputLimit input_limit() {
  return {.floor = {0.25, 8 << 20}, .per_byte = {50e-6, 4096}};
}

}  // namespace splatlas

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const splatlas::CostLimit limit(splatlas::input_limit().of(size), "the input");
  splatlas::fuzz({data, size});
  return 0;
}
