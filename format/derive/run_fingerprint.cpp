#include "format/derive/run_fingerprint.h"

namespace splatlas {

namespace {

constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;
/// Evaluation points: digits of pi and of e, reduced by the prime.
constexpr std::array<std::uint64_t, 2> kBases{0x0'243f'6a88'85a3'08d3 % kPrime,
                                              0x0'2b7e'1516'28ae'd2a6 % kPrime};

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

constexpr std::uint64_t inverse(std::uint64_t a) {
  return power(a, kPrime - 2);
}

}  // namespace

RunFingerprinter::Powers::Powers(std::uint64_t base) : table_(std::size_t{kDigits} << kDigitBits) {
  for (unsigned digit = 0; digit < kDigits; ++digit) {
    std::uint64_t* row = table_.data() + (std::size_t{digit} << kDigitBits);
    row[0] = 1;
    for (std::size_t n = 1; n < std::size_t{1} << kDigitBits; ++n) row[n] = multiply(row[n - 1], base);
    base = power(base, std::uint64_t{1} << kDigitBits);
  }
}

std::uint64_t RunFingerprinter::Powers::of(std::uint64_t exponent) const {
  constexpr std::uint64_t kDigitMask = (std::uint64_t{1} << kDigitBits) - 1;
  std::uint64_t result = table_[exponent & kDigitMask];
  for (unsigned digit = 1; digit < kDigits; ++digit) {
    const std::uint64_t value = (exponent >> (digit * kDigitBits)) & kDigitMask;
    result = multiply(result, table_[(std::size_t{digit} << kDigitBits) + value]);
  }
  return result;
}

RunFingerprinter::RunFingerprinter(const Index3& size) : size_(size), stride_{1, size[0], size[0] * size[1]} {
  for (const std::uint64_t base : kBases) {
    Point point{Powers(base), {}};
    for (std::size_t a = 0; a < 3; ++a) {
      point.inverse[a] = inverse(subtract(power(base, static_cast<std::uint64_t>(stride_[a])), 1));
    }
    points_.push_back(std::move(point));
  }
}

VoxelSetFingerprint RunFingerprinter::of(std::span<const Run> runs, Axis axis) const {
  const ScanOrder order = ScanOrder::of(axis);
  const auto slice_stride = static_cast<std::uint64_t>(stride_[order.slice_axis]);
  const auto row_stride = static_cast<std::uint64_t>(stride_[order.row_axis]);
  const auto stride = static_cast<std::uint64_t>(stride_[order.scan_axis]);
  const auto rows = static_cast<std::uint64_t>(size_[order.row_axis]);
  VoxelSetFingerprint sums{};
  for (const Run& run : runs) {
    const std::uint64_t slice = run.scanline / rows, row = run.scanline % rows;
    const std::uint64_t first = slice * slice_stride + row * row_stride + run.start * stride;
    // Sum the geometric series base^first + base^(first + stride) + ...
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const Point& point = points_[p];
      const std::uint64_t difference =
          subtract(point.powers.of(first + run.length * stride), point.powers.of(first));
      sums[p] = add(sums[p], multiply(difference, point.inverse[order.scan_axis]));
    }
  }
  return sums;
}

}  // namespace splatlas
