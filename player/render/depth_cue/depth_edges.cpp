#include "player/render/depth_cue/depth_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace splatlas {
namespace {

constexpr int kRings = 4;
constexpr int kPairsOfRing = 8;
constexpr std::size_t kPairs = 32;
static_assert(kPairs == std::size_t{kRings} * kPairsOfRing);
constexpr std::size_t kRowsPerJob = 16;

/// Filter radius, relative to a picture's smaller side; at least kMinRadius pixels.
constexpr double kRadius = 1.0 / 48;
constexpr double kMinRadius = 2;
/// Range relative to the radius: a depth step of one radius, halved by the mean of a pair, saturates.
constexpr double kRange = 0.5;
/// Smaller differences, relative to the range, are within the error of voxel depths.
constexpr double kMinShare = 1.0 / 32;

/// Offset to one of two opposite pixels.
struct Pair {
  int right = 0, down = 0;
  float weight = 0;
};

/// Concentric rings of pairs, each rotated against the last. Weights of sum 1 fall linearly with the radius.
std::array<Pair, kPairs> pairs_of(double radius) {
  std::array<Pair, kPairs> pairs;
  std::size_t number = 0;
  constexpr double kAll = kPairsOfRing * kRings * (kRings + 1) / 2.0;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int n = 0; n < kPairsOfRing; ++n) {
      const double angle = std::numbers::pi * (n + static_cast<double>(ring) / kRings) / kPairsOfRing;
      const double away = radius * (ring + 1) / kRings;
      pairs[number++] = {static_cast<int>(std::lround(away * std::cos(angle))),
                         static_cast<int>(std::lround(away * std::sin(angle))),
                         static_cast<float>((kRings - ring) / kAll)};
    }
  }
  return pairs;
}

/// Depth darkening of picture rows.
class RowDarkener {
 public:
  RowDarkener(const DepthMap& depths, const DepthEdges& edges, Picture& picture)
      : depths_(depths), edges_(edges), picture_(picture), pairs_(pairs_of(edges.radius)) {}

  void darken(int row) {
    // Find the extent of the foreground
    const int width = depths_.size.width, height = depths_.size.height;
    const float* here = row_of(row);
    first_ = 0;
    last_ = width;
    while (first_ < last_ && here[first_] == DepthMap::kBackground) ++first_;
    while (first_ < last_ && here[last_ - 1] == DepthMap::kBackground) --last_;
    if (first_ == last_) return;

    // Accumulate the weighted pairs
    shares_.assign(static_cast<std::size_t>(width), 0.0f);
    for (const Pair& pair : pairs_) {
      if (row - pair.down < 0 || row + pair.down >= height) continue;
      add_pair(pair, row);
    }

    // Darken the foreground
    float* row_rgba = &picture_.rgba[4 * picture_.size.pixel(0, row)];
    for (int x = first_; x < last_; ++x) {
      if (here[x] == DepthMap::kBackground) continue;
      float* rgba = row_rgba + 4 * static_cast<std::ptrdiff_t>(x);
      const float factor = 1 - edges_.strength * shares_[static_cast<std::size_t>(x)];
      for (int c = 0; c < 3; ++c) rgba[c] *= factor;
    }
  }

 private:
  [[nodiscard]] const float* row_of(int row) const { return &depths_.mm[depths_.size.pixel(0, row)]; }

  void add_pair(const Pair& pair, int row) {
    const float* here = row_of(row);
    const float* below = row_of(row + pair.down);
    const float* above = row_of(row - pair.down);
    const int right = pair.right;
    const int aside = std::abs(pair.right);
    const auto scale = static_cast<float>(1 / edges_.range_mm);
    const auto offset = static_cast<float>(edges_.min_mm / edges_.range_mm);
    const float weight = pair.weight;
    float* shares = shares_.data();
    const int end = std::min(last_, depths_.size.width - aside);
    for (int x = std::max(first_, aside); x < end; ++x) {
      // Background yields -infinity or NaN, which fails the comparison below.
      const float behind = (here[x] - 0.5f * (below[x + right] + above[x - right])) * scale - offset;
      const float share = behind > 0 ? behind : 0;
      shares[x] += weight * (share < 1 ? share : 1);
    }
  }

  const DepthMap& depths_;
  const DepthEdges& edges_;
  Picture& picture_;
  std::array<Pair, kPairs> pairs_;
  int first_ = 0, last_ = 0;  // extent of the foreground in columns
  std::vector<float> shares_;
};

/// Rounding error of depths, relative to the maximum depth: some tens of operations in single precision.
constexpr double kMinOfDepth = 32.0 / (1 << 23);

/// Maximum magnitude of the depths.
double max_depth_mm(const DepthMap& depths) {
  float max_depth = 0;
  for (const float mm : depths.mm)
    max_depth = std::max(max_depth, mm == DepthMap::kBackground ? 0 : std::abs(mm));
  return static_cast<double>(max_depth);
}

}  // namespace

DepthEdges depth_edges(const ParallelView& plane, float strength) {
  DepthEdges edges;
  edges.strength = std::clamp(strength, 0.0f, 1.0f);
  edges.radius = std::max(kMinRadius, kRadius * std::min(plane.size.width, plane.size.height));
  edges.range_mm = kRange * edges.radius * plane.mm_per_pixel;
  edges.min_mm = kMinShare * edges.range_mm;
  return edges;
}

void darken_edges(const DepthMap& depths, const DepthEdges& requested, Picture& picture, ThreadPool& pool) {
  DepthEdges edges = requested;
  edges.min_mm = std::max(requested.min_mm, kMinOfDepth * max_depth_mm(depths));
  const auto rows = static_cast<std::size_t>(depths.size.height);
  pool.for_each((rows + kRowsPerJob - 1) / kRowsPerJob, [&](std::size_t job) {
    RowDarkener darkener(depths, edges, picture);
    const std::size_t end = std::min(rows, (job + 1) * kRowsPerJob);
    for (std::size_t row = job * kRowsPerJob; row < end; ++row) darkener.darken(static_cast<int>(row));
  });
}

}  // namespace splatlas
