#include "bench/measure/peak_memory.h"

#include <fstream>
#include <string>

#include "format/result_macros.h"

namespace splatlas {
namespace {

/// A field of /proc/self/status in kB, converted to bytes.
Result<std::uint64_t> status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key; status.ignore(1 << 16, '\n')) {
    if (std::uint64_t kilobytes = 0; key == name + ":" && status >> kilobytes) return kilobytes * 1024;
  }
  return fail(ErrorCode::kFailed, "/proc/self/status: does not tell " + name);
}

}  // namespace

Result<PeakMemory> PeakMemory::start() {
  std::ofstream peak("/proc/self/clear_refs");
  peak << "5" << std::flush;  // resets the peak to the current resident size
  if (!peak) return fail(ErrorCode::kFailed, "/proc/self/clear_refs: the peak of memory cannot be set back");
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t before, status_bytes("VmRSS"));
  return PeakMemory(before);
}

Result<std::uint64_t> PeakMemory::grown_bytes() const {
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t peak, status_bytes("VmHWM"));
  return peak > before_ ? peak - before_ : 0;
}

}  // namespace splatlas
