#include "player/rasterize.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "player/facing.h"

namespace splatlas {
namespace {

constexpr int kSubPixelBits = 8;  // vertices snap to 1/256 pixel: edge functions are exact integers
constexpr double kSubPixels = 1 << kSubPixelBits;
constexpr double kGuardBand = double{1 << 20};  // pixels; products of differences then fit 64 bits
constexpr int kBandRows = 16;
constexpr std::size_t kTrianglesPerChunk = 4096;
/// Surfaces coincide whose depths lie in the same 1/4096 voxel. The offset keeps the limits away from the
/// depths that surfaces between voxels have, where rounding would decide.
constexpr double kDepthSteps = 4096;
constexpr double kDepthOffset = 0.3183;

/// Continuous voxel indices to picture coordinates.
class Projection {
 public:
  Projection(const ParallelView& view, const Grid& grid) {
    const Affine to_lps = index_to_lps_mm(grid);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        x_[a] += view.right_lps[b] * to_lps.linear[3 * b + a] / view.mm_per_pixel;
        y_[a] -= view.up_lps[b] * to_lps.linear[3 * b + a] / view.mm_per_pixel;
      }
      x0_ += view.right_lps[a] * (to_lps.offset[a] - view.center_lps_mm[a]) / view.mm_per_pixel;
      y0_ -= view.up_lps[a] * (to_lps.offset[a] - view.center_lps_mm[a]) / view.mm_per_pixel;
    }
    x0_ += 0.5 * view.size.width;
    y0_ += 0.5 * view.size.height;
  }
  [[nodiscard]] double x(const std::array<float, 3>& p) const {
    return x_[0] * p[0] + x_[1] * p[1] + x_[2] * p[2] + x0_;
  }
  [[nodiscard]] double y(const std::array<float, 3>& p) const {
    return y_[0] * p[0] + y_[1] * p[1] + y_[2] * p[2] + y0_;
  }

 private:
  Vec3 x_{0, 0, 0}, y_{0, 0, 0};
  double x0_ = 0, y0_ = 0;
};

struct ScreenVertex {
  std::int64_t x = 0, y = 0;        ///< in 1/256 pixel, pixel centres at multiples of 256
  double exact_x = 0, exact_y = 0;  ///< in pixels, not snapped
  bool valid = false;
};

ScreenVertex screen_vertex(const Projection& projection, const std::array<float, 3>& position) {
  const double x = projection.x(position) - 0.5;
  const double y = projection.y(position) - 0.5;
  if (!(std::abs(x) < kGuardBand && std::abs(y) < kGuardBand)) return {};
  return {std::llround(x * kSubPixels), std::llround(y * kSubPixels), x, y, true};
}

/// Pixel numbers whose centres lie within [low, high] (1/256 pixel).
std::int64_t first_pixel(std::int64_t low) {
  return (low + (1 << kSubPixelBits) - 1) >> kSubPixelBits;
}
std::int64_t last_pixel(std::int64_t high) {
  return high >> kSubPixelBits;
}

struct TriangleRef {
  std::uint32_t surface = 0, triangle = 0;
};

/// Depth over a triangle. From vertices that are not snapped, so that coplanar triangles agree wherever they
/// cover the same pixel, however each surface is cut into triangles.
class DepthPlane {
 public:
  DepthPlane(const std::array<ScreenVertex, 3>& v, const std::array<double, 3>& depth)
      : x0_(v[0].exact_x), y0_(v[0].exact_y), depth0_(depth[0]) {
    std::tie(nearest_, furthest_) = std::minmax({depth[0], depth[1], depth[2]});
    const double x1 = v[1].exact_x - x0_;
    const double y1 = v[1].exact_y - y0_;
    const double x2 = v[2].exact_x - x0_;
    const double y2 = v[2].exact_y - y0_;
    const double area = x1 * y2 - y1 * x2;
    if (area == 0) return;
    per_x_ = ((depth[1] - depth0_) * y2 - (depth[2] - depth0_) * y1) / area;
    per_y_ = ((depth[2] - depth0_) * x1 - (depth[1] - depth0_) * x2) / area;
  }
  /// Snapping lets a triangle cover centres that are just beside it: clamped to the depths of its corners.
  [[nodiscard]] double at(std::int64_t x, std::int64_t y) const {
    const double depth =
        depth0_ + per_x_ * (static_cast<double>(x) - x0_) + per_y_ * (static_cast<double>(y) - y0_);
    return std::clamp(depth, nearest_, furthest_);
  }

 private:
  double x0_, y0_, depth0_;
  double per_x_ = 0, per_y_ = 0;
  double nearest_ = 0, furthest_ = 0;
};

/// A fragment with what sorting needs.
struct Sample {
  Fragment fragment;
  std::int64_t depth_key = 0;
  bool entering = false;
  std::uint32_t triangle = 0;

  /// Order within a pixel.
  [[nodiscard]] auto key() const { return std::tuple(depth_key, entering, fragment.structure, triangle); }
};

/// All triangles that touch one band of picture rows, to sorted fragments.
class BandRasterizer {
 public:
  BandRasterizer(std::span<const SurfaceDraw> surfaces, std::span<const std::vector<ScreenVertex>> vertices,
                 const ParallelView& view, const Shear& shear, const Facing& facing, const Lighting& lighting,
                 int first_row, int last_row)
      : surfaces_(surfaces),
        vertices_(vertices),
        facing_(facing),
        lighting_(lighting),
        width_(view.size.width),
        first_row_(first_row),
        last_row_(last_row),
        slice_axis_(shear.scan.slice_axis),
        depth_sign_(shear.ascending ? 1.0 : -1.0) {
    nearest_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(last_row - first_row));
  }

  void draw(const TriangleRef& ref) {
    const SurfaceDraw& surface = surfaces_[ref.surface];
    const std::array<std::uint32_t, 3>& corner = surface.mesh->triangles[ref.triangle];
    std::array<ScreenVertex, 3> v;
    std::array<double, 3> depth{};
    for (std::size_t n = 0; n < 3; ++n) {
      v[n] = vertices_[ref.surface][corner[n]];
      depth[n] = depth_sign_ * static_cast<double>(surface.mesh->positions_ijk[corner[n]][slice_axis_]);
    }
    const std::int64_t doubled_area =
        (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[1].y - v[0].y) * (v[2].x - v[0].x);
    if (doubled_area == 0) return;
    // Orient counter-clockwise in (x right, y down) so that the inside has positive edge functions.
    std::array<std::size_t, 3> order{0, 1, 2};
    if (doubled_area < 0) std::swap(order[1], order[2]);
    const ScreenVertex& a = v[order[0]];
    const ScreenVertex& b = v[order[1]];
    const ScreenVertex& c = v[order[2]];
    const std::int64_t area = std::abs(doubled_area);
    const DepthPlane plane(v, depth);
    const bool front = facing_.shows_front(*surface.mesh, corner);
    const std::int64_t y_first = std::max<std::int64_t>(first_row_, first_pixel(std::min({a.y, b.y, c.y})));
    const std::int64_t y_last = std::min<std::int64_t>(last_row_ - 1, last_pixel(std::max({a.y, b.y, c.y})));
    const std::int64_t x_first = std::max<std::int64_t>(0, first_pixel(std::min({a.x, b.x, c.x})));
    const std::int64_t x_last = std::min<std::int64_t>(width_ - 1, last_pixel(std::max({a.x, b.x, c.x})));
    for (std::int64_t y = y_first; y <= y_last; ++y) {
      for (std::int64_t x = x_first; x <= x_last; ++x) {
        const std::int64_t px = x << kSubPixelBits;
        const std::int64_t py = y << kSubPixelBits;
        const std::int64_t edge_a = edge(b, c, px, py);
        const std::int64_t edge_b = edge(c, a, px, py);
        const std::int64_t edge_c = edge(a, b, px, py);
        if (!inside(edge_a, b, c) || !inside(edge_b, c, a) || !inside(edge_c, a, b)) continue;
        std::array<float, 3> weight{};
        weight[order[0]] = static_cast<float>(static_cast<double>(edge_a) / static_cast<double>(area));
        weight[order[1]] = static_cast<float>(static_cast<double>(edge_b) / static_cast<double>(area));
        weight[order[2]] = static_cast<float>(static_cast<double>(edge_c) / static_cast<double>(area));
        add(surface, ref, front, weight, plane.at(x, y), x, y);
      }
    }
  }

  /// Sorted by pixel and depth; the opaque fragment of a pixel last.
  std::vector<Fragment> take() {
    for (const Sample& sample : nearest_) {
      if (sample.fragment.structure != kNoStructure) samples_.push_back(sample);
    }
    // By pixel: a counting sort of indices. Then the few of a pixel by depth.
    std::vector<std::uint32_t> end_of_pixel(nearest_.size() + 1, 0);
    for (const Sample& sample : samples_) ++end_of_pixel[nearest_index(sample.fragment.pixel) + 1];
    for (std::size_t n = 1; n < end_of_pixel.size(); ++n) end_of_pixel[n] += end_of_pixel[n - 1];
    std::vector<std::uint32_t> order(samples_.size());
    for (std::uint32_t n = 0; n < samples_.size(); ++n) {
      order[end_of_pixel[nearest_index(samples_[n].fragment.pixel)]++] = n;
    }
    std::vector<Fragment> fragments;
    fragments.reserve(samples_.size());
    for (std::size_t pixel = 0; pixel < nearest_.size(); ++pixel) {
      const std::uint32_t begin = pixel == 0 ? 0 : end_of_pixel[pixel - 1];
      const std::span<std::uint32_t> of_pixel(order.data() + begin, end_of_pixel[pixel] - begin);
      std::sort(of_pixel.begin(), of_pixel.end(),
                [&](std::uint32_t a, std::uint32_t b) { return samples_[a].key() < samples_[b].key(); });
      for (const std::uint32_t n : of_pixel) {
        fragments.push_back(samples_[n].fragment);
        if (samples_[n].fragment.rgba[3] >= 1) break;  // hides what is behind
      }
    }
    return fragments;
  }

  [[nodiscard]] std::size_t samples() const { return samples_.size(); }

 private:
  static std::int64_t edge(const ScreenVertex& from, const ScreenVertex& to, std::int64_t x, std::int64_t y) {
    return (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x);
  }
  /// Centres on an edge belong to the triangle whose left or top edge it is.
  static bool inside(std::int64_t value, const ScreenVertex& from, const ScreenVertex& to) {
    if (value != 0) return value > 0;
    return to.y < from.y || (to.y == from.y && to.x > from.x);
  }
  [[nodiscard]] std::size_t nearest_index(std::uint32_t pixel) const {
    return pixel - static_cast<std::size_t>(first_row_) * static_cast<std::size_t>(width_);
  }

  void add(const SurfaceDraw& surface, const TriangleRef& ref, bool front, const std::array<float, 3>& weight,
           double depth, std::int64_t x, std::int64_t y) {
    const SurfaceMesh& mesh = *surface.mesh;
    const std::array<std::uint32_t, 3>& corner = mesh.triangles[ref.triangle];
    std::array<float, 3> normal{};
    for (std::size_t n = 0; n < 3; ++n) {
      for (std::size_t c = 0; c < 3; ++c) normal[c] += weight[n] * mesh.normals_lps[corner[n]][c];
    }
    if (!front) normal = {-normal[0], -normal[1], -normal[2]};
    Sample sample;
    sample.fragment.depth = static_cast<float>(depth);
    sample.fragment.pixel = static_cast<std::uint32_t>(y * width_ + x);
    sample.fragment.structure = surface.structure;
    sample.depth_key = static_cast<std::int64_t>(std::floor(depth * kDepthSteps + kDepthOffset));
    sample.entering = front;
    sample.triangle = ref.triangle;
    Sample& nearest = nearest_[nearest_index(sample.fragment.pixel)];
    const bool is_nearest = nearest.fragment.structure == kNoStructure || sample.key() < nearest.key();
    if (!is_nearest) return;
    const std::array<float, 3> color = lighting_.shade(surface.color, normal);
    for (std::size_t c = 0; c < 3; ++c) sample.fragment.rgba[c] = color[c] * surface.opacity;
    sample.fragment.rgba[3] = surface.opacity;
    if (surface.opacity >= 1) {
      nearest = sample;
    } else {
      samples_.push_back(sample);
    }
  }

  std::span<const SurfaceDraw> surfaces_;
  std::span<const std::vector<ScreenVertex>> vertices_;
  const Facing& facing_;
  const Lighting& lighting_;
  std::int64_t width_;
  int first_row_, last_row_;
  std::size_t slice_axis_;
  double depth_sign_;
  std::vector<Sample> nearest_;  // opaque, per pixel of the band
  std::vector<Sample> samples_;  // translucent
};

/// Triangles of one chunk that reach at least one pixel centre, per band.
using Bins = std::vector<std::vector<TriangleRef>>;

struct Chunk {
  std::uint32_t surface = 0;
  std::uint32_t first = 0, last = 0;
};

Bins bin_triangles(const Chunk& chunk, const SurfaceDraw& surface, std::span<const ScreenVertex> vertices,
                   const PictureSize& size, std::size_t bands) {
  Bins bins(bands);
  for (std::uint32_t t = chunk.first; t < chunk.last; ++t) {
    const auto& corner = surface.mesh->triangles[t];
    const ScreenVertex& a = vertices[corner[0]];
    const ScreenVertex& b = vertices[corner[1]];
    const ScreenVertex& c = vertices[corner[2]];
    if (!a.valid || !b.valid || !c.valid) continue;
    const std::int64_t x_first = std::max<std::int64_t>(0, first_pixel(std::min({a.x, b.x, c.x})));
    const std::int64_t x_last = std::min<std::int64_t>(size.width - 1, last_pixel(std::max({a.x, b.x, c.x})));
    const std::int64_t y_first = std::max<std::int64_t>(0, first_pixel(std::min({a.y, b.y, c.y})));
    const std::int64_t y_last =
        std::min<std::int64_t>(size.height - 1, last_pixel(std::max({a.y, b.y, c.y})));
    if (x_first > x_last || y_first > y_last) continue;
    for (std::int64_t band = y_first / kBandRows; band <= y_last / kBandRows; ++band) {
      bins[static_cast<std::size_t>(band)].push_back({chunk.surface, t});
    }
  }
  return bins;
}

}  // namespace

SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& look, const SurfaceMesh& mesh) {
  return {&mesh,
          s,
          {srgb_to_linear(look.color.r), srgb_to_linear(look.color.g), srgb_to_linear(look.color.b)},
          look.opacity.value_or(1.0f)};
}

Result<RasterCounters> rasterize(std::span<const SurfaceDraw> surfaces, const ParallelView& view,
                                 const Shear& shear, const Grid& grid, const Lighting& lighting,
                                 std::size_t max_fragments, FragmentList& out, ThreadPool& pool) {
  RasterCounters counters;
  const auto height = static_cast<std::size_t>(view.size.height);
  out.fragments.clear();
  out.first_of_row.assign(height + 1, 0);

  // Project every vertex once; cut the triangles into chunks that do not depend on the number of threads.
  const Projection projection(view, grid);
  std::vector<std::vector<ScreenVertex>> vertices(surfaces.size());
  pool.for_each(surfaces.size(), [&](std::size_t s) {
    const auto& positions = surfaces[s].mesh->positions_ijk;
    vertices[s].resize(positions.size());
    for (std::size_t n = 0; n < positions.size(); ++n)
      vertices[s][n] = screen_vertex(projection, positions[n]);
  });
  std::vector<Chunk> chunks;
  for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
    const std::size_t triangles = surfaces[s].mesh->triangles.size();
    counters.triangles += triangles;
    for (std::size_t first = 0; first < triangles; first += kTrianglesPerChunk) {
      chunks.push_back({s, static_cast<std::uint32_t>(first),
                        static_cast<std::uint32_t>(std::min(first + kTrianglesPerChunk, triangles))});
    }
  }
  if (chunks.empty()) return counters;
  const std::size_t bands = (height + kBandRows - 1) / kBandRows;
  std::vector<Bins> bins(chunks.size());
  pool.for_each(chunks.size(), [&](std::size_t n) {
    const Chunk& chunk = chunks[n];
    bins[n] = bin_triangles(chunk, surfaces[chunk.surface], vertices[chunk.surface], view.size, bands);
  });

  // Opaque surfaces first: what they hide is never shaded.
  const Facing facing(view, grid);
  std::vector<std::vector<Fragment>> fragments(bands);
  std::atomic<std::size_t> total{0};
  std::atomic<bool> too_many{false};
  pool.for_each(bands, [&](std::size_t band) {
    const int first_row = static_cast<int>(band) * kBandRows;
    BandRasterizer rasterizer(surfaces, vertices, view, shear, facing, lighting, first_row,
                              std::min(first_row + kBandRows, view.size.height));
    for (const bool opaque : {true, false}) {
      for (const Bins& chunk_bins : bins) {
        for (const TriangleRef& ref : chunk_bins[band]) {
          if ((surfaces[ref.surface].opacity >= 1) == opaque) rasterizer.draw(ref);
        }
        if (total.load(std::memory_order_relaxed) + rasterizer.samples() > max_fragments) too_many = true;
        if (too_many) return;
      }
    }
    fragments[band] = rasterizer.take();
    if (total += fragments[band].size(); total > max_fragments) too_many = true;
  });
  if (too_many) {
    return fail(
        ErrorCode::kLimit,
        fmt::format(
            "the surfaces leave more than {} fragments in this picture; make it smaller or select fewer "
            "translucent surfaces",
            max_fragments));
  }

  out.fragments.reserve(total);
  for (const std::vector<Fragment>& band : fragments) {
    out.fragments.insert(out.fragments.end(), band.begin(), band.end());
    for (const Fragment& fragment : band) {
      ++out.first_of_row[fragment.pixel / static_cast<std::uint32_t>(view.size.width) + 1];
    }
  }
  for (std::size_t row = 0; row < height; ++row) out.first_of_row[row + 1] += out.first_of_row[row];
  return counters;
}

}  // namespace splatlas
