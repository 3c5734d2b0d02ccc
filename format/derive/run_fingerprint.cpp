#include "format/derive/run_fingerprint.h"

#include <algorithm>

#include "format/tasks/task_control.h"

namespace splatlas {

namespace {

constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;
/// Digits of pi, reduced by the prime.
constexpr std::uint64_t kBase = 0x243f'6a88'85a3'08d3 % kPrime;

__extension__ using Product = unsigned __int128;

constexpr std::uint64_t add(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t sum = a + b;
  return sum >= kPrime ? sum - kPrime : sum;
}
constexpr std::uint64_t subtract(std::uint64_t a, std::uint64_t b) {
  return a >= b ? a - b : a + kPrime - b;
}

constexpr std::uint64_t multiply(std::uint64_t a, std::uint64_t b) {
  const Product product = static_cast<Product>(a) * b;
  return add(static_cast<std::uint64_t>(product & kPrime), static_cast<std::uint64_t>(product >> 61));
}

constexpr std::uint64_t power(std::uint64_t base, std::uint64_t exponent) {
  std::uint64_t result = 1;
  for (; exponent != 0; exponent >>= 1) {
    if (exponent & 1) result = multiply(result, base);
    base = multiply(base, base);
  }
  return result;
}

/// Voxels along an axis whose powers need no second table.
constexpr unsigned kLowBits = 12;
constexpr std::uint64_t kLow = std::uint64_t{1} << kLowBits;

std::vector<std::uint64_t> powers_of(std::uint64_t base, std::uint64_t count) {
  std::vector<std::uint64_t> powers(count, 1);
  for (std::size_t n = 1; n < count; ++n) powers[n] = multiply(powers[n - 1], base);
  return powers;
}

}  // namespace

VoxelSetFingerprint add_fingerprints(VoxelSetFingerprint a, VoxelSetFingerprint b) {
  return add(a, b);
}
VoxelSetFingerprint subtract_fingerprints(VoxelSetFingerprint a, VoxelSetFingerprint b) {
  return subtract(a, b);
}
bool is_fingerprint(std::uint64_t value) {
  return value < kPrime;
}

RunFingerprinter::Powers::Powers(std::uint64_t step, std::int64_t side)
    : low_(powers_of(step, std::min<std::uint64_t>(static_cast<std::uint64_t>(side) + 1, kLow))),
      high_(powers_of(power(step, kLow), (static_cast<std::uint64_t>(side) >> kLowBits) + 1)),
      series_factor_(power(subtract(step, 1), kPrime - 2)) {}

std::uint64_t RunFingerprinter::Powers::of(std::uint64_t n) const {
  const std::uint64_t low = low_[n % kLow];
  return n < kLow ? low : multiply(low, high_[n >> kLowBits]);
}

RunFingerprinter::RunFingerprinter(const Index3& size)
    : size_(size),
      powers_{Powers(kBase, size[0]), Powers(power(kBase, static_cast<std::uint64_t>(size[0])), size[1]),
              Powers(power(kBase, static_cast<std::uint64_t>(size[0] * size[1])), size[2])} {}

VoxelSetFingerprint RunFingerprinter::of(std::span<const Run> runs, Axis axis) const {
  const ScanOrder order = ScanOrder::of(axis);
  const auto rows = static_cast<std::uint64_t>(size_[order.row_axis]);
  const Powers& along = powers_[order.scan_axis];
  std::uint64_t sum = 0, scanline = 0, row_power = 1;
  TaskPace pace;
  for (const Run& run : runs) {
    pace.step();
    if (run.scanline != scanline) {
      scanline = run.scanline;
      row_power = multiply(powers_[order.slice_axis].of(scanline / rows),
                           powers_[order.row_axis].of(scanline % rows));
    }
    // Geometric series step^start + step^(start + 1) + ..., without its factor
    const std::uint64_t start = run.start;
    sum = add(sum, multiply(row_power, subtract(along.of(start + run.length), along.of(start))));
  }
  return multiply(sum, along.series_factor());
}

std::vector<VoxelSetFingerprint> RunFingerprinter::of_classes(const RunModel& model) const {
  std::vector<VoxelSetFingerprint> fingerprints(model.classes.size());
  VoxelSetFingerprint rest = of_grid();
  for (ClassId c = 1; c < fingerprints.size(); ++c) {
    fingerprints[c] = of(model.classes[c], model.axis);
    rest = subtract_fingerprints(rest, fingerprints[c]);
  }
  fingerprints[kEmptyClass] = rest;
  return fingerprints;
}

VoxelSetFingerprint RunFingerprinter::of_grid() const {
  std::uint64_t product = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::uint64_t series = subtract(powers_[a].of(static_cast<std::uint64_t>(size_[a])), 1);
    product = multiply(product, multiply(series, powers_[a].series_factor()));
  }
  return product;
}

}  // namespace splatlas
