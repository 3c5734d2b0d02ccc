#include "format/derive/coarse_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>

#include "format/derive/fit_surface.h"
#include "format/derive/structure_crop.h"
#include "format/derive/surface_net.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Range of isovalues, as shares. Beyond one half, touching structures would leave gaps.
constexpr int kMinIso = Coverage::kFull / 10, kMaxIso = Coverage::kFull / 2;
/// Least share of a ridge.
constexpr int kMinRidge = Coverage::kFull / 8;
/// Share of a structure that its surface may miss: 1 / kMaxLost.
constexpr std::uint64_t kMaxLost = 100;
/// Distance that vertices keep from the ends of their edges.
constexpr float kMinOffset = 0.02f;

/// The coverage of a structure, with access to neighbours.
class Field {
 public:
  explicit Field(const Coverage& coverage)
      : size_(coverage.size()),
        steps_{1, size_[0], size_[0] * size_[1]},
        shares_(coverage.shares().begin(), coverage.shares().end()) {
    rows_.resize(static_cast<std::size_t>(size_[1] * size_[2]));
    for (std::int64_t row = 0; row < std::ssize(rows_); ++row) {
      const auto begin = shares_.begin() + row * size_[0], end = begin + size_[0];
      const auto covered = [](std::uint16_t share) { return share > 0; };
      const auto first = std::find_if(begin, end, covered);
      if (first == end) continue;
      const auto last = std::find_if(std::reverse_iterator(end), std::reverse_iterator(first), covered);
      rows_[static_cast<std::size_t>(row)] = {first - begin, last.base() - begin};
    }
  }

  [[nodiscard]] int at(std::int64_t block) const { return shares_[static_cast<std::size_t>(block)]; }
  void set(std::int64_t block, int share) {
    shares_[static_cast<std::size_t>(block)] = static_cast<std::uint16_t>(share);
  }
  [[nodiscard]] const Index3& size() const { return size_; }
  /// Blocks from a block to the next along each axis.
  [[nodiscard]] const Index3& steps() const { return steps_; }

  /// Calls visit(block) for the blocks of each row from its first covered one to its last one.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (std::int64_t row = 0; row < std::ssize(rows_); ++row) visit_row(row, row_at(row), visit);
  }
  /// Calls visit(first corner) for the cells of eight blocks with such blocks.
  template <typename Visit>
  void for_each_cell(const Visit& visit) const {
    for (std::int64_t row = 0; row + size_[1] + 1 < std::ssize(rows_); ++row) {
      Extent cells;
      for (const std::int64_t of : {row, row + 1, row + size_[1], row + size_[1] + 1}) {
        cells.first = std::min(cells.first, row_at(of).first - 1);
        cells.last = std::max(cells.last, row_at(of).last);
      }
      visit_row(row, cells, visit);
    }
  }

  /// Sobel gradient: differences, smoothed across them.
  [[nodiscard]] std::array<int, 3> gradient(std::int64_t block) const {
    std::array<int, 3> sum{};
    for (int k = -1; k <= 1; ++k) {
      for (int j = -1; j <= 1; ++j) {
        const std::int64_t row = block + j * steps_[1] + k * steps_[2];
        const int before = at(row - 1), here = at(row), after = at(row + 1);
        const int smooth = before + 2 * here + after, weight_j = 2 - std::abs(j), weight_k = 2 - std::abs(k);
        sum[0] += weight_j * weight_k * (after - before);
        sum[1] += j * weight_k * smooth;
        sum[2] += weight_j * k * smooth;
      }
    }
    return sum;
  }

 private:
  /// Blocks of a row, [first, last); none by default.
  struct Extent {
    std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = 0;
  };
  [[nodiscard]] const Extent& row_at(std::int64_t row) const { return rows_[static_cast<std::size_t>(row)]; }
  template <typename Visit>
  void visit_row(std::int64_t row, const Extent& blocks, const Visit& visit) const {
    check_task();
    for (std::int64_t n = blocks.first; n < blocks.last; ++n) visit(row * size_[0] + n);
  }

  Index3 size_, steps_;
  std::vector<std::uint16_t> shares_;
  std::vector<Extent> rows_;  // from the first covered block to the last one
};

/// The isovalue at which the trilinear field holds as many eighths of blocks as the structure does. Each cell
/// of eight blocks is sampled at the middle of its eighths.
int isovalue_of(const Field& field) {
  constexpr int kBinBits = 9, kBins = 1 << kBinBits;
  static_assert(Coverage::kFull >= kBins);
  std::vector<std::uint64_t> held(kBins + 1);  // [sample in steps of kFull / kBins]
  std::uint64_t voxels = 0;
  const std::int64_t j = field.steps()[1], k = field.steps()[2];
  field.for_each([&](std::int64_t block) { voxels += static_cast<std::uint64_t>(field.at(block)); });
  field.for_each_cell([&](std::int64_t block) {
    std::array<int, 8> corners{};
    for (unsigned c = 0; c < 8; ++c) corners[c] = field.at(block + (c & 1) + (c >> 1 & 1) * j + (c >> 2) * k);
    // One axis after the other: three quarters of the nearer corner, one of the other
    for (unsigned axis = 1; axis < 8; axis <<= 1) {
      for (unsigned c = 0; c < 8; ++c) {
        if ((c & axis) != 0) continue;
        const int low = corners[c], high = corners[c | axis];
        corners[c] = 3 * low + high;
        corners[c | axis] = low + 3 * high;
      }
    }
    for (const int sample : corners)
      ++held[static_cast<std::size_t>(sample / (64 * Coverage::kFull / kBins))];
  });
  const std::uint64_t eighths = 8 * voxels / Coverage::kFull;
  std::uint64_t sum = 0;
  int bin = kBins;
  for (; bin > 0; --bin) {
    sum += held[static_cast<std::size_t>(bin)];
    if (sum >= eighths) break;
  }
  return std::clamp(bin * (Coverage::kFull / kBins), kMinIso, kMaxIso);
}

/// Raises ridges above the isovalue: blocks without a neighbour above it that cover the most along an axis.
void raise_ridges(int isovalue, Field& field) {
  std::vector<std::int64_t> ridges;
  field.for_each([&](std::int64_t block) {
    const int here = field.at(block);
    if (here < kMinRidge || here >= isovalue) return;
    bool is_ridge = false;
    for (const std::int64_t step : field.steps()) {
      const int before = field.at(block - step), after = field.at(block + step);
      if (std::max(before, after) >= isovalue) return;
      is_ridge = is_ridge || (here >= std::max(before, after) && here > std::min(before, after));
    }
    if (is_ridge) ridges.push_back(block);
  });
  for (const std::int64_t block : ridges) field.set(block, (isovalue + Coverage::kFull) / 2);
}

/// The blocks inside. Their cells have the order of boundary voxels, for the net.
StructureCrop inside_of(const Coverage& coverage, const Field& field, int isovalue) {
  StructureCrop crop{.first = coverage.first(), .size = coverage.size(), .parts = {}};
  crop.parts.resize(coverage.shares().size(), StructureCrop::kOutside);
  field.for_each([&](std::int64_t block) {
    if (field.at(block) >= isovalue) crop.parts[static_cast<std::size_t>(block)] = StructureCrop::kBoundary;
  });
  return crop;
}

/// True if blocks without an inside neighbour hold more of the structure than its surface may miss.
bool misses_parts(const Coverage& coverage, const Field& field, const StructureCrop& crop) {
  std::uint64_t voxels = 0, lost = 0;
  const std::int64_t j = field.steps()[1], k = field.steps()[2];
  const auto is_near = [&](std::int64_t block) {
    for (std::int64_t slice = -k; slice <= k; slice += k) {
      for (std::int64_t row = -j; row <= j; row += j) {
        for (std::int64_t n = block + slice + row - 1; n <= block + slice + row + 1; ++n) {
          if (crop.parts[static_cast<std::size_t>(n)] != StructureCrop::kOutside) return true;
        }
      }
    }
    return false;
  };
  field.for_each([&](std::int64_t block) {
    const std::uint64_t share = coverage.shares()[static_cast<std::size_t>(block)];
    voxels += share;
    if (share > 0 && !is_near(block)) lost += share;
  });
  return lost > voxels / kMaxLost;
}

/// Position and outward gradient of a vertex, in blocks.
struct PlacedVertex {
  std::array<float, 3> position{}, outwards{};
};

PlacedVertex place(const NetVertex& vertex, const Coverage& coverage, const Field& field, int isovalue) {
  const std::size_t axis = vertex.axis();
  std::int64_t block = 0;
  PlacedVertex placed;
  for (std::size_t a = 0; a < 3; ++a) {
    block += (vertex.voxel[a] - coverage.first()[a]) * field.steps()[a];
    placed.position[a] = static_cast<float>(vertex.voxel[a]);
  }
  const std::int64_t next = block + field.steps()[axis];
  const float from = static_cast<float>(field.at(block)), to = static_cast<float>(field.at(next));
  const float offset =
      std::clamp((from - static_cast<float>(isovalue)) / (from - to), kMinOffset, 1 - kMinOffset);
  placed.position[axis] += offset;
  const std::array<int, 3> here = field.gradient(block), there = field.gradient(next);
  for (std::size_t a = 0; a < 3; ++a) {
    placed.outwards[a] = (offset - 1) * static_cast<float>(here[a]) - offset * static_cast<float>(there[a]);
  }
  // In thin parts, the gradient may point inwards along the edge
  placed.outwards[axis] = std::copysign(std::max(std::abs(placed.outwards[axis]), 1.0f), from - to);
  return placed;
}

}  // namespace

Coverage::Coverage(const IndexBox& box, int level) : level_(level) {
  std::size_t blocks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    first_[a] = (box.first[a] >> level) - kMargin;
    size_[a] = (box.last[a] >> level) + kMargin + 1 - first_[a];
    blocks *= static_cast<std::size_t>(size_[a]);
  }
  shares_.resize(blocks);
}

double Coverage::blocks(const IndexBox& box, int level) {
  double blocks = 1;
  for (std::size_t a = 0; a < 3; ++a)
    blocks *= static_cast<double>((box.last[a] >> level) - (box.first[a] >> level) + 1 + 2 * kMargin);
  return blocks;
}

void Coverage::add(std::span<const Run> runs, std::int64_t rows) {
  const auto unit = static_cast<std::uint16_t>(kFull >> (3 * level_));
  const std::uint32_t width = 1u << level_;
  TaskPace pace;
  for (const Run& run : runs) {
    pace.step();
    const auto scanline = static_cast<std::int64_t>(run.scanline);
    const std::int64_t j = (scanline % rows >> level_) - first_[1],
                       k = (scanline / rows >> level_) - first_[2];
    std::uint16_t* const row = &shares_[static_cast<std::size_t>((k * size_[1] + j) * size_[0] - first_[0])];
    const std::uint32_t end = run.start + run.length;
    for (std::uint32_t voxel = run.start; voxel < end;) {
      const std::uint32_t block = voxel >> level_, next = std::min(end, (block + 1) * width);
      row[block] = static_cast<std::uint16_t>(row[block] + (next - voxel) * unit);
      voxel = next;
    }
  }
}

std::optional<SurfaceMesh> coarse_surface(const Coverage& coverage, const Grid& grid) {
  Field field(coverage);
  const int isovalue = isovalue_of(field);
  raise_ridges(isovalue, field);
  const StructureCrop crop = inside_of(coverage, field, isovalue);
  if (misses_parts(coverage, field, crop)) return std::nullopt;
  SurfaceNet net = surface_net(crop);

  SurfaceMesh mesh = triangles_of(net, grid, SurfaceRule::kSmooth);
  const auto width = static_cast<float>(1 << coverage.level());
  const VoxelNormals normals(grid);
  TaskPace pace;
  for (const NetVertex& vertex : net.vertices) {
    pace.step();
    const PlacedVertex placed = place(vertex, coverage, field, isovalue);
    std::array<float, 3>& position = mesh.positions_ijk.emplace_back(placed.position);
    for (float& p : position) p = (p + 0.5f) * width - 0.5f;
    std::array<float, 3>& normal = mesh.normals_lps.emplace_back(normals.to_lps(placed.outwards));
    const float length = std::sqrt(dot(normal, normal));
    for (float& n : normal) n /= length;
  }
  return mesh;
}

}  // namespace splatlas
