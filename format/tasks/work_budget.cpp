#include "format/tasks/work_budget.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace splatlas {
namespace {

constexpr double kSmallFileBytes = 1 << 20;
constexpr double kSecondsOfSmallFile = 30, kSecondsPerFurtherByte = 1e-5;
constexpr double kMemoryOfSmallFile = 0x1p31, kMemoryPerFurtherByte = 0x1p11;
constexpr double kLeastMemory = 0.25;  // a second of work may need as much memory as a minute

/// Rounded up to two digits below 1, and to an integer above.
std::string factor_to_allow(double factor) {
  return factor > 1 ? fmt::format("{:.0f}", std::ceil(factor))
                    : fmt::format("{}", std::ceil(factor * 1000) / 1000);
}

}  // namespace

WorkBudget::WorkBudget(std::string file_name, std::uint64_t file_bytes, double max_work,
                       std::uint64_t machine_bytes)
    : file_name_(std::move(file_name)),
      file_bytes_(file_bytes),
      max_work_(max_work > 0 ? max_work : 1) {  // 1 for NaN
  const double further = std::max(0.0, static_cast<double>(file_bytes) - kSmallFileBytes);
  const auto machine = static_cast<double>(machine_bytes);
  cpu_seconds_ = max_work_ * (kSecondsOfSmallFile + kSecondsPerFurtherByte * further);
  const double memory =
      std::max(max_work_, kLeastMemory) * (kMemoryOfSmallFile + kMemoryPerFurtherByte * further);
  memory_bytes_ = std::min(memory, std::max(max_work_, 1.0) * machine / 2);
}

Error WorkBudget::time_exceeded() const {
  constexpr double kFurther = 10;
  return {ErrorCode::kLimit,
          fmt::format(
              "{}: takes more than {:.3g} s of CPU time, the limit of a file of {} bytes. If you trust the "
              "file, allow it with --max-work {}",
              file_name_, cpu_seconds_, file_bytes_, factor_to_allow(kFurther * max_work_)),
          file_name_};
}

Error WorkBudget::memory_exceeded(double bytes) const {
  return {ErrorCode::kLimit,
          fmt::format(
              "{}: takes {:.0f} MiB of memory at once; the limit of a file of {} bytes is {:.0f} MiB. If you "
              "trust the file, allow it with --max-work {}",
              file_name_, bytes / 0x1p20, file_bytes_, memory_bytes_ / 0x1p20,
              factor_to_allow(max_work_ * bytes / memory_bytes_)),
          file_name_};
}

}  // namespace splatlas
