#include "tests/reference/grey_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "format/tasks/thread_pool.h"
#include "tests/reference/cubic.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMinTransmittance = 1e-7;
/// Part of a cell in which a cubic grey value crosses a knot at most once; further crossings are missed.
constexpr int kPartsPerCell = 8;

/// Gauss-Legendre quadrature with four nodes on [0, 1], exact for polynomials of degree 7.
constexpr std::array<Node, 4> kNodes{{{0.06943184420297371, 0.17392742256872693},
                                      {0.33000947820757187, 0.32607257743127307},
                                      {0.66999052179242813, 0.32607257743127307},
                                      {0.93056815579702629, 0.17392742256872693}}};

/// Trilinear weights of the eight corners of a cell (i fastest) at a point of a ray.
std::array<double, 8> corner_weights(const Vec3& index, const Index3& cell) {
  const double x = index[0] - static_cast<double>(cell[0]);
  const double y = index[1] - static_cast<double>(cell[1]);
  const double z = index[2] - static_cast<double>(cell[2]);
  return {(1 - x) * (1 - y) * (1 - z), x * (1 - y) * (1 - z), (1 - x) * y * (1 - z), x * y * (1 - z),
          (1 - x) * (1 - y) * z,       x * (1 - y) * z,       (1 - x) * y * z,       x * y * z};
}

/// Cell traversal along a ray (Amanatides and Woo 1987).
class CellWalk {
 public:
  CellWalk(const Index3& size, const Ray& ray, double from_mm) : ray_(ray) {
    const RayInterval interval = clip_to_field(ray, size, {from_mm, kInfinity});
    from_mm_ = interval.from_mm;
    to_mm_ = interval.to_mm;
    if (!inside()) return;
    const Vec3 entry = ray.at(from_mm_);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<std::int64_t>(std::floor(entry[a]));
      cell_[a] = std::clamp<std::int64_t>(i, -1, size[a] - 1);
      exit_mm_[a] = exit_of(a);
    }
  }

  [[nodiscard]] bool inside() const { return from_mm_ < to_mm_; }
  [[nodiscard]] const Index3& cell() const { return cell_; }
  [[nodiscard]] double from_mm() const { return from_mm_; }
  [[nodiscard]] double to_mm() const { return std::min({exit_mm_[0], exit_mm_[1], exit_mm_[2], to_mm_}); }

  void next() {
    const double exit = to_mm();
    const auto a =
        static_cast<std::size_t>(std::min_element(exit_mm_.begin(), exit_mm_.end()) - exit_mm_.begin());
    from_mm_ = std::max(from_mm_, exit);
    if (exit_mm_[a] >= to_mm_) {
      to_mm_ = -kInfinity;
      return;
    }
    cell_[a] += ray_.per_mm[a] > 0 ? 1 : -1;
    exit_mm_[a] = exit_of(a);
  }

 private:
  [[nodiscard]] double exit_of(std::size_t a) const {
    if (ray_.per_mm[a] == 0) return kInfinity;
    const auto plane = static_cast<double>(cell_[a] + (ray_.per_mm[a] > 0 ? 1 : 0));
    return (plane - ray_.start[a]) / ray_.per_mm[a];
  }

  const Ray& ray_;
  double from_mm_ = 0, to_mm_ = 0;
  Index3 cell_{0, 0, 0};
  Vec3 exit_mm_{0, 0, 0};
};

/// Piece of an appearance, linear in the grey value.
struct Segment {
  GreyAppearance::Knot at_0;  // extrapolated to grey value 0
  GreyAppearance::Knot per_grey;
};

Segment segment_at(const GreyAppearance& appearance, double grey) {
  const auto above =
      std::upper_bound(appearance.knots.begin(), appearance.knots.end(), grey,
                       [](double g, const GreyAppearance::Knot& knot) { return g < knot.grey; });
  Segment segment;
  if (above == appearance.knots.begin() || above == appearance.knots.end()) {
    segment.at_0 = above == appearance.knots.begin() ? appearance.knots.front() : appearance.knots.back();
    return segment;
  }
  const GreyAppearance::Knot& below = *(above - 1);
  const double width = above->grey - below.grey;
  segment.per_grey.extinction_per_mm = (above->extinction_per_mm - below.extinction_per_mm) / width;
  segment.at_0.extinction_per_mm = below.extinction_per_mm - segment.per_grey.extinction_per_mm * below.grey;
  for (std::size_t c = 0; c < 3; ++c) {
    segment.per_grey.color[c] = (above->color[c] - below.color[c]) / width;
    segment.at_0.color[c] = below.color[c] - segment.per_grey.color[c] * below.grey;
  }
  return segment;
}

/// Parameter in [t0, t1] at which the cubic equals `value`, by bisection. Its ends lie on different sides.
double crossing(const Cubic& cubic, double value, double t0, double t1) {
  const bool rises = cubic(t1) > cubic(t0);
  for (int n = 0; n < 50; ++n) {
    const double middle = 0.5 * (t0 + t1);
    ((cubic(middle) < value) == rises ? t0 : t1) = middle;
  }
  return 0.5 * (t0 + t1);
}

/// `lighting(t)`: factor of the colour.
template <typename LightingAt>
RayRadiance integrate_classified(const Cubic& grey, const GreyAppearance& appearance,
                                 const LightingAt& lighting, double t0, double t1, double length_mm) {
  const Segment segment = segment_at(appearance, grey(0.5 * (t0 + t1)));
  const double slope = segment.per_grey.extinction_per_mm;
  const Cubic extinction{{segment.at_0.extinction_per_mm + slope * grey.a[0], slope * grey.a[1],
                          slope * grey.a[2], slope * grey.a[3]}};
  const auto emission = [&](double t) {
    std::array<double, 3> emitted{};
    const double lit = lighting(t);
    for (std::size_t c = 0; c < 3; ++c) {
      emitted[c] = lit * extinction(t) * (segment.at_0.color[c] + segment.per_grey.color[c] * grey(t));
    }
    return emitted;
  };
  return integrate(kNodes, extinction, emission, t0, t1, length_mm);
}

/// A segment with a cubic grey value, cut at the knots of the appearance.
template <typename LightingAt>
RayRadiance classify_after(const Cubic& grey, const GreyAppearance& appearance, const LightingAt& lighting,
                           double lowest, double highest, double length_mm) {
  std::vector<double> inner;  // knots within the range of the cell
  for (const GreyAppearance::Knot& knot : appearance.knots) {
    if (knot.grey > lowest && knot.grey < highest && (inner.empty() || inner.back() != knot.grey)) {
      inner.push_back(knot.grey);
    }
  }
  if (inner.empty()) return integrate_classified(grey, appearance, lighting, 0, 1, length_mm);
  std::vector<double> cuts{0};
  for (int part = 0; part < kPartsPerCell; ++part) {
    const double t0 = static_cast<double>(part) / kPartsPerCell;
    const double t1 = static_cast<double>(part + 1) / kPartsPerCell;
    const double g0 = grey(t0);
    const double g1 = grey(t1);
    for (const double knot : inner) {
      if ((g0 < knot) != (g1 < knot)) cuts.push_back(crossing(grey, knot, t0, t1));
    }
  }
  cuts.push_back(1);
  std::sort(cuts.begin(), cuts.end());
  RayRadiance sum;
  for (std::size_t n = 1; n < cuts.size(); ++n) {
    if (cuts[n] > cuts[n - 1])
      sum.add(integrate_classified(grey, appearance, lighting, cuts[n - 1], cuts[n], length_mm));
  }
  return sum;
}

}  // namespace

GreyTruth::GreyTruth(const MaskedVolume& volume, GreyAppearance appearance, Classification classification,
                     const ParallelView* lit_for)
    : volume_(volume), appearance_(std::move(appearance)), classification_(classification), optics_(256) {
  for (std::size_t grey = 0; grey < optics_.size(); ++grey) {
    const GreyAppearance::Knot knot = appearance_.at(static_cast<double>(grey));
    optics_[grey] = {knot.extinction_per_mm, knot.extinction_per_mm * knot.color[0],
                     knot.extinction_per_mm * knot.color[1], knot.extinction_per_mm * knot.color[2]};
  }
  if (lit_for != nullptr && !volume.normals.empty()) {
    constexpr std::size_t kNormals = std::size_t{std::numeric_limits<PackedNormal>::max()} + 1;
    for (std::size_t n = 0; n < kNormals; ++n) {
      const std::array<float, 3> normal = unpack_normal(static_cast<PackedNormal>(n));
      factors_.push_back(diffuse(*lit_for, {normal[0], normal[1], normal[2]}));
    }
  }
  mark_visible_cells();
}

std::size_t GreyTruth::cell_number(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const Index3& size = volume_.grid.size;
  return static_cast<std::size_t>(((k + 1) * (size[1] + 1) + j + 1) * (size[0] + 1) + i + 1);
}

GreyTruth::Corners GreyTruth::corners_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const Index3& size = volume_.grid.size;
  if (i >= 0 && j >= 0 && k >= 0 && i + 1 < size[0] && j + 1 < size[1] && k + 1 < size[2]) {
    const std::uint8_t* low = volume_.greys.data() + volume_.grid.offset(i, j, k);
    const std::uint8_t* high = low + size[0] * size[1];
    return {low[0],  low[1],  low[size[0]],  low[size[0] + 1],
            high[0], high[1], high[size[0]], high[size[0] + 1]};
  }
  Corners corners{};
  for (std::int64_t n = 0; n < 8; ++n) {
    corners[static_cast<std::size_t>(n)] = volume_.at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
  }
  return corners;
}

std::array<GreyTruth::CornerLighting, 8> GreyTruth::lighting_of(const Index3& cell) const {
  std::array<CornerLighting, 8> lighting;
  for (std::int64_t n = 0; n < 8; ++n) {
    const std::int64_t i = cell[0] + (n & 1), j = cell[1] + (n >> 1 & 1), k = cell[2] + (n >> 2);
    if (!volume_.grid.contains(i, j, k)) continue;
    const auto voxel = static_cast<std::size_t>(volume_.grid.offset(i, j, k));
    const std::int32_t normal = volume_.normals[voxel];
    if (normal == MaskedVolume::kOutside) continue;
    const double factor = normal == MaskedVolume::kUnlit ? 1 : factors_[static_cast<std::size_t>(normal)];
    const double lit = volume_.lit.empty() ? 1 : volume_.lit[voxel];
    lighting[static_cast<std::size_t>(n)] = {1 + lit * (factor - 1), 1};
  }
  return lighting;
}

void GreyTruth::mark_visible_cells() {
  // Minimum visible grey value at or above each integer, for a constant-time test of a cell.
  std::array<double, 257> first_visible{};
  first_visible[256] = kInfinity;
  for (std::size_t grey = 256; grey-- > 0;) {
    const auto here = static_cast<double>(grey);
    bool above = grey < 255 && optics_[grey + 1][0] > 0;
    for (const GreyAppearance::Knot& knot : appearance_.knots) {
      above = above || (knot.grey > here && knot.grey < here + 1 && knot.extinction_per_mm > 0);
    }
    first_visible[grey] = optics_[grey][0] > 0 ? here : above ? here + 0.5 : first_visible[grey + 1];
  }
  const Index3& size = volume_.grid.size;
  visible_.resize(static_cast<std::size_t>((size[0] + 1) * (size[1] + 1) * (size[2] + 1)));
  for (std::int64_t k = -1; k < size[2]; ++k) {
    for (std::int64_t j = -1; j < size[1]; ++j) {
      for (std::int64_t i = -1; i < size[0]; ++i) {
        const Corners greys = corners_of(i, j, k);
        const auto [low, high] = std::minmax_element(greys.begin(), greys.end());
        const bool shows =
            classification_ == Classification::kAfter
                ? first_visible[*low] <= static_cast<double>(*high)
                : std::any_of(greys.begin(), greys.end(), [&](std::uint8_t g) { return optics_[g][0] > 0; });
        visible_[cell_number(i, j, k)] = shows ? 1 : 0;
      }
    }
  }
}

RayRadiance GreyTruth::in_cell(const Corners& corners, const Ray& ray, const Index3& cell, double from_mm,
                               double to_mm) const {
  const double length_mm = to_mm - from_mm;
  std::array<std::array<double, 8>, 4> weights;
  for (std::size_t n = 0; n < 4; ++n) {
    weights[n] = corner_weights(ray.at(from_mm + length_mm * static_cast<double>(n) / 3), cell);
  }
  std::array<CornerLighting, 8> lighting;
  if (!factors_.empty()) lighting = lighting_of(cell);
  if (classification_ == Classification::kAfter) {
    std::array<double, 4> grey{}, factor{}, members{};
    for (std::size_t n = 0; n < 4; ++n) {
      for (std::size_t c = 0; c < 8; ++c) {
        grey[n] += weights[n][c] * corners[c];
        factor[n] += weights[n][c] * lighting[c].factor;
        members[n] += weights[n][c] * lighting[c].member;
      }
    }
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
    const Cubic greys = Cubic::through(grey[0], grey[1], grey[2], grey[3]);
    if (factors_.empty())
      return classify_after(
          greys, appearance_, [](double) { return 1.0; }, *low, *high, length_mm);
    const Cubic factors = Cubic::through(factor[0], factor[1], factor[2], factor[3]);
    const Cubic weight = Cubic::through(members[0], members[1], members[2], members[3]);
    const auto mean_factor = [&](double t) { return weight(t) > 0 ? factors(t) / weight(t) : 1.0; };
    return classify_after(greys, appearance_, mean_factor, *low, *high, length_mm);
  }
  std::array<std::array<double, 4>, 4> optics{};
  for (std::size_t c = 0; c < 8; ++c) {
    std::array<double, 4> corner = optics_[corners[c]];
    if (!factors_.empty()) {
      for (std::size_t channel = 1; channel < 4; ++channel) corner[channel] *= lighting[c].factor;
    }
    for (std::size_t n = 0; n < 4; ++n) {
      for (std::size_t channel = 0; channel < 4; ++channel)
        optics[n][channel] += weights[n][c] * corner[channel];
    }
  }
  std::array<Cubic, 4> cubics{};
  for (std::size_t channel = 0; channel < 4; ++channel) {
    cubics[channel] =
        Cubic::through(optics[0][channel], optics[1][channel], optics[2][channel], optics[3][channel]);
  }
  const auto emission = [&](double t) { return std::array{cubics[1](t), cubics[2](t), cubics[3](t)}; };
  return integrate(kNodes, cubics[0], emission, 0, 1, length_mm);
}

RayRadiance GreyTruth::along(const Ray& ray, double from_mm) const {
  RayRadiance sum;
  for (CellWalk walk(volume_.grid.size, ray, from_mm); walk.inside(); walk.next()) {
    const Index3& cell = walk.cell();
    if (visible_[cell_number(cell[0], cell[1], cell[2])] == 0 || !(walk.to_mm() > walk.from_mm())) continue;
    sum.add(in_cell(corners_of(cell[0], cell[1], cell[2]), ray, cell, walk.from_mm(), walk.to_mm()));
    if (sum.transmittance < kMinTransmittance) break;
  }
  return sum;
}

namespace {

/// `ray(x, y)`: the ray through picture coordinates.
template <typename RayOfPixel>
ReferencePicture render(const GreyTruth& truth, const PictureSize& size, const RayOfPixel& ray,
                        double from_mm, unsigned threads) {
  const auto width = static_cast<std::size_t>(size.width);
  ReferencePicture picture{size, {}};
  picture.pixels.resize(width * static_cast<std::size_t>(size.height));
  const auto render_row = [&](std::size_t row) {
    for (std::size_t column = 0; column < width; ++column) {
      const Ray pixel_ray = ray(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
      picture.pixels[row * width + column] = truth.along(pixel_ray, from_mm).rgba();
    }
  };
  parallel_for(static_cast<std::size_t>(size.height), threads, render_row, [](std::size_t) {});
  return picture;
}

}  // namespace

ReferencePicture render_grey_truth(const GreyTruth& truth, const Grid& grid, const ParallelView& view,
                                   unsigned threads) {
  const auto ray = [&](double x, double y) { return ray_through(view, grid, x, y); };
  return render(truth, view.size, ray, -kInfinity, threads);
}

ReferencePicture render_grey_truth(const GreyTruth& truth, const Grid& grid, const PerspectiveView& view,
                                   unsigned threads) {
  const auto ray = [&](double x, double y) { return ray_through(view, grid, x, y); };
  return render(truth, view.in_plane.size, ray, 0, threads);
}

}  // namespace splatlas::reference
