#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "format/atlas_reader.h"
#include "format/system/memory_limit.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

constexpr double kSmallFileBytes = 1 << 20;
constexpr double kUnitsOfSmallFile = 3e10, kUnitsPerFurtherByte = 1e4;
constexpr double kUnitsPerByteHeld = 4;

/// The factor, rounded up to two digits below 1, and to an integer above.
std::string factor_to_allow(double factor) {
  return factor > 1 ? fmt::format("{:.0f}", std::ceil(factor))
                    : fmt::format("{}", std::ceil(factor * 1000) / 1000);
}

constexpr std::array<const char*, kWorkKinds> kNames{
    "decoded bytes", "runs", "voxels", "triangles", "rows of tables", "pixels of a sheet",
};

}  // namespace

void Work::add(WorkKind kind, double count, double units_each) {
  const auto n = static_cast<std::size_t>(kind);
  counts_[n] += count;
  units_[n] += count * units_each;
}

void Work::hold(double bytes) {
  held_bytes_ = std::max(held_bytes_, bytes);
}

Work& Work::operator+=(const Work& other) {
  for (std::size_t n = 0; n < kWorkKinds; ++n) {
    counts_[n] += other.counts_[n];
    units_[n] += other.units_[n];
  }
  hold(other.held_bytes_);
  return *this;
}

Work& Work::then(const Work& step) {
  for (std::size_t n = 0; n < kWorkKinds; ++n) {
    counts_[n] = std::max(counts_[n], step.counts_[n]);
    units_[n] += step.units_[n];
  }
  hold(step.held_bytes_);
  return *this;
}

void Work::limit(WorkKind kind, double count) {
  double& known = counts_[static_cast<std::size_t>(kind)];
  known = std::min(known, count);
}

double Work::time_units() const {
  return std::accumulate(units_.begin(), units_.end(), 0.0);
}

double Work::units() const {
  return std::max(time_units(), held_bytes_ * kUnitsPerByteHeld);
}

std::string Work::largest() const {
  const auto most = std::ranges::max_element(units_);
  const auto n = static_cast<std::size_t>(most - units_.begin());
  return fmt::format("{:.3g} {}", counts_[n], kNames[n]);
}

WorkBudget::WorkBudget(std::string file_name, std::uint64_t file_bytes, double max_work,
                       std::uint64_t machine_bytes)
    : file_name_(std::move(file_name)),
      file_bytes_(file_bytes),
      max_work_(max_work > 0 ? max_work : 1),  // 1 for NaN
      memory_bytes_(static_cast<double>(machine_bytes > 0 ? machine_bytes : machine_memory()) / 2) {}

double WorkBudget::allowed() const {
  const double further = std::max(0.0, static_cast<double>(file_bytes_) - kSmallFileBytes);
  return max_work_ * (kUnitsOfSmallFile + kUnitsPerFurtherByte * further);
}

Result<void> WorkBudget::check(const Work& work, std::string_view purpose) const {
  if (work.held_bytes() > max_work_ * memory_bytes_) {
    return fail(
        ErrorCode::kLimit,
        "{}: {} holds {:.0f} MiB at once; a file may take {:.0f} MiB. If you trust the file, allow it with "
        "--max-work {}",
        file_name_, purpose, work.held_bytes() / 0x1p20, max_work_ * memory_bytes_ / 0x1p20,
        factor_to_allow(work.held_bytes() / memory_bytes_));
  }
  const double units = work.time_units();
  if (units <= allowed()) return {};
  return fail(ErrorCode::kLimit,
              "{}: {} takes {:.3g} units of work ({}); a file of {} bytes may take {:.3g}. If you trust the "
              "file, allow it with --max-work {}",
              file_name_, purpose, units, work.largest(), file_bytes_, allowed(),
              factor_to_allow(units / allowed() * max_work_));
}

}  // namespace splatlas
