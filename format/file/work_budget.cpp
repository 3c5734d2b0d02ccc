#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "format/atlas_reader.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

constexpr double kSmallFileBytes = 1 << 20;
constexpr double kUnitsOfSmallFile = 8e8, kUnitsPerFurtherByte = 1e4;
/// 200 MB take the budget of a small file.
constexpr double kUnitsPerByteHeld = 4;

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

double Work::units() const {
  double sum = 0;
  for (const double units : units_) sum += units;
  return std::max(sum, held_bytes_ * kUnitsPerByteHeld);
}

std::string Work::largest() const {
  const auto most = std::ranges::max_element(units_);
  if (*most < held_bytes_ * kUnitsPerByteHeld) return fmt::format("{:.0f} MiB at once", held_bytes_ / 0x1p20);
  const auto n = static_cast<std::size_t>(most - units_.begin());
  return fmt::format("{:.3g} {}", counts_[n], kNames[n]);
}

WorkBudget::WorkBudget(std::string file_name, std::uint64_t file_bytes, double max_work)
    : file_name_(std::move(file_name)),
      file_bytes_(file_bytes),
      max_work_(max_work > 1 ? max_work : 1) {}  // 1 for NaN

double WorkBudget::allowed() const {
  const double further = std::max(0.0, static_cast<double>(file_bytes_) - kSmallFileBytes);
  return max_work_ * (kUnitsOfSmallFile + kUnitsPerFurtherByte * further);
}

Result<void> WorkBudget::check(const Work& work, std::string_view purpose) const {
  const double units = work.units(), allowed_once = allowed() / max_work_;
  if (units <= allowed()) return {};
  return fail(ErrorCode::kLimit,
              "{}: {} takes {:.3g} units of work ({}); a file of {} bytes may take {:.3g}. If you trust the "
              "file, allow it with --max-work {:.0f}",
              file_name_, purpose, units, work.largest(), file_bytes_, allowed(),
              std::ceil(units / allowed_once));
}

}  // namespace splatlas
