#include "player/cast_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "player/projection.h"

namespace splatlas {
namespace {

constexpr int kBlockSide = 4;  // pixels: a packet
constexpr auto kSide = static_cast<std::size_t>(kBlockSide);
static_assert(kSide * kSide == kPacketRays);
constexpr int kTileSide = 32;  // pixels: what a thread takes
constexpr float kFarAway = 1e9f;

using Numbers = std::array<double, kPacketRays>;

/// Rays of one packet: at s, a ray is at start + s * direction.
struct Lines {
  std::array<Numbers, 3> start{}, direction{};
  Numbers direction_mm{};  // length of the direction
};

/// The rays of a view in positions of a ray volume, linear in picture coordinates.
class PixelRays {
 public:
  PixelRays(const View& view, const Grid& grid, const Index3& first) : perspective_(view.eye_mm.has_value()) {
    Affine to_place = lps_mm_to_index(grid);
    for (std::size_t a = 0; a < 3; ++a) to_place.offset[a] -= static_cast<double>(first[a]);
    const ParallelView& plane = view.plane;
    Vec3 right = plane.right_lps, down = plane.up_lps;
    for (std::size_t a = 0; a < 3; ++a) {
      right[a] *= plane.mm_per_pixel;
      down[a] *= -plane.mm_per_pixel;
    }
    eye_ = to_place.apply(view.eye_lps_mm());
    corner_ = to_place.apply(plane.point_lps_mm(0, 0));
    right_ = to_place.apply_linear(right);
    down_ = to_place.apply_linear(down);
    forward_ = to_place.apply_linear(plane.forward_lps);
    eye_mm_ = view.eye_mm.value_or(0);
    mm_per_pixel_ = plane.mm_per_pixel;
    middle_x_ = 0.5 * plane.size.width;
    middle_y_ = 0.5 * plane.size.height;
  }

  [[nodiscard]] bool perspective() const { return perspective_; }

  /// Through these picture coordinates.
  [[nodiscard]] Lines through(const Numbers& x, const Numbers& y) const {
    Lines lines;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        const double point = corner_[a] + x[n] * right_[a] + y[n] * down_[a];
        lines.start[a][n] = perspective_ ? eye_[a] : point;
        lines.direction[a][n] = perspective_ ? point - eye_[a] : forward_[a];
      }
    }
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const double right_mm = (x[n] - middle_x_) * mm_per_pixel_;
      const double down_mm = (y[n] - middle_y_) * mm_per_pixel_;
      const double square = eye_mm_ * eye_mm_ + right_mm * right_mm + down_mm * down_mm;
      lines.direction_mm[n] = perspective_ ? std::sqrt(square) : 1.0;
    }
    return lines;
  }

 private:
  bool perspective_;
  Vec3 eye_{}, corner_{}, right_{}, down_{}, forward_{};
  double eye_mm_ = 0, mm_per_pixel_ = 0, middle_x_ = 0, middle_y_ = 0;
};

/// Another axis than the best one is taken only where no more than so many voxels lie between its planes.
constexpr double kMaxSlope = 100;

/// The axis along which a ray passes most voxels, or the one that is forced.
std::size_t principal_axis(const Lines& lines, std::size_t n, const std::optional<Axis>& forced) {
  const auto voxels = [&](std::size_t axis) { return std::abs(lines.direction[axis][n]); };
  std::size_t principal = 2;
  for (const std::size_t axis : {1u, 0u}) {
    if (voxels(axis) > voxels(principal)) principal = axis;
  }
  if (!forced) return principal;
  const auto axis = static_cast<std::size_t>(*forced);
  return voxels(axis) * kMaxSlope >= voxels(principal) ? axis : principal;
}

/// Rays [first, last) of a packet: t counts planes along their principal axis.
void set_rays(const Lines& lines, std::size_t principal, bool from_start, std::size_t first, std::size_t last,
              RayPacket& packet) {
  for (std::size_t n = first; n < last; ++n) {
    const double ahead = lines.direction[principal][n];
    const double along = 1 / std::abs(ahead);
    const double t_start = ahead > 0 ? lines.start[principal][n] : -lines.start[principal][n];
    for (std::size_t a = 0; a < 3; ++a) {
      const double step = lines.direction[a][n] * along;
      packet.step[a][n] = static_cast<float>(step);
      packet.origin[a][n] = static_cast<float>(lines.start[a][n] - step * t_start);
    }
    packet.step[principal][n] = ahead > 0 ? 1.0f : -1.0f;
    packet.origin[principal][n] = 0;
    packet.mm_per_t[n] = static_cast<float>(lines.direction_mm[n] * along);
    packet.from[n] =
        from_start ? static_cast<float>(std::clamp<double>(t_start, -kFarAway, kFarAway)) : -kFarAway;
    packet.to[n] = kFarAway;
  }
}

/// Pixels of the picture.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;  // right and bottom excluded
};

/// The pixels whose rays can come within one voxel of the volume's voxels.
PixelBox shown_box(const RayVolume& volume, const View& view, const Grid& grid) {
  const PictureSize& size = view.plane.size;
  const PixelBox all{0, 0, size.width, size.height};
  const Projection projection(view.plane, grid,
                              view.eye_mm.value_or(std::numeric_limits<double>::infinity()));
  double left = size.width, top = size.height, right = 0, bottom = 0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::array<float, 3> index{};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t place = (corner >> a & 1) != 0 ? volume.grid().size[a] - 2 : 1;
      index[a] = static_cast<float>(volume.first()[a] + place);
    }
    const ScreenPoint point = projection.homogeneous(index);
    constexpr double kNear = 1e-3;  // the eye is inside the box, or it is next to it
    if (point.w < kNear) return all;
    left = std::min(left, point.x / point.w);
    right = std::max(right, point.x / point.w);
    top = std::min(top, point.y / point.w);
    bottom = std::max(bottom, point.y / point.w);
  }
  constexpr double kRounding = 1;
  const auto pixel = [](double at, int most) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(most)));
  };
  return {pixel(std::floor(left - kRounding), size.width), pixel(std::floor(top - kRounding), size.height),
          pixel(std::ceil(right + kRounding) + 1, size.width),
          pixel(std::ceil(bottom + kRounding) + 1, size.height)};
}

class Tile {
 public:
  Tile(const PixelRays& rays, const MarchScene& scene, const MarchKernels& kernels,
       const CastOptions& options, Picture& picture)
      : rays_(rays), scene_(scene), kernels_(kernels), options_(options), picture_(picture) {}

  void render(const PixelBox& box) const {
    for (int y = box.top; y < box.bottom; y += kBlockSide) {
      for (int x = box.left; x < box.right; x += kBlockSide) render_block(x, y);
    }
  }

 private:
  void render_block(int left, int top) const {
    Numbers x{}, y{};
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      // Beyond the picture's edge, the ray of the pixel on it once more.
      x[n] = std::min(left + static_cast<int>(n) % kBlockSide, picture_.size.width - 1) + 0.5;
      y[n] = std::min(top + static_cast<int>(n) / kBlockSide, picture_.size.height - 1) + 0.5;
    }
    const Lines lines = rays_.through(x, y);
    const auto principal = [&](std::size_t n) { return principal_axis(lines, n, options_.principal_axis); };
    const std::size_t first = principal(0);
    // Directions closest to one end of an axis are a convex cone: what its corners are, the whole block is.
    const bool same = [&] {
      for (const std::size_t corner : {kSide - 1, kPacketRays - kSide, kPacketRays - 1}) {
        if (principal(corner) != first ||
            (lines.direction[first][corner] > 0) != (lines.direction[first][0] > 0)) {
          return false;
        }
      }
      return true;
    }();
    RayPacket packet;
    if (same) {
      set_rays(lines, first, rays_.perspective(), 0, kPacketRays, packet);
    } else {
      for (std::size_t n = 0; n < kPacketRays; ++n) {
        set_rays(lines, principal(n), rays_.perspective(), n, n + 1, packet);
      }
    }
    LightPacket light;
    kernels_.march(scene_, packet, light);
    const int columns = std::min(kBlockSide, picture_.size.width - left);
    const int rows = std::min(kBlockSide, picture_.size.height - top);
    for (int row = 0; row < rows; ++row) {
      float* out = &picture_.rgba[4 * (static_cast<std::size_t>(top + row) *
                                           static_cast<std::size_t>(picture_.size.width) +
                                       static_cast<std::size_t>(left))];
      for (int column = 0; column < columns; ++column) {
        const auto n = static_cast<std::size_t>(row * kBlockSide + column);
        for (std::size_t c = 0; c < 4; ++c) *out++ = light.planes[c][n];
      }
    }
  }

  const PixelRays& rays_;
  const MarchScene& scene_;
  const MarchKernels& kernels_;
  const CastOptions& options_;
  Picture& picture_;
};

}  // namespace

void cast_rays(const RayVolume& volume, const View& view, const Grid& grid, const CastOptions& options,
               const MarchKernels& kernels, Picture& picture, ThreadPool& pool) {
  const PictureSize size = view.plane.size;
  picture.size = size;
  picture.rgba.assign(4 * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height), 0.0f);
  if (volume.empty()) return;
  const PixelRays rays(view, grid, volume.first());
  const MarchScene scene{.grid = volume.grid(),
                         .sources = volume.sources(),
                         .active = volume.active(),
                         .floor = options.floor,
                         .least_steps = options.least_steps,
                         .most_steps = options.most_steps,
                         .tolerance = options.tolerance};
  const Tile tile(rays, scene, kernels, options, picture);
  const PixelBox shown = shown_box(volume, view, grid);
  const int columns = (shown.right - shown.left + kTileSide - 1) / kTileSide;
  const int rows = (shown.bottom - shown.top + kTileSide - 1) / kTileSide;
  if (columns <= 0 || rows <= 0) return;
  pool.for_each(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t n) {
    const int left = shown.left + static_cast<int>(n % static_cast<std::size_t>(columns)) * kTileSide;
    const int top = shown.top + static_cast<int>(n / static_cast<std::size_t>(columns)) * kTileSide;
    tile.render(
        {left, top, std::min(left + kTileSide, shown.right), std::min(top + kTileSide, shown.bottom)});
  });
}

}  // namespace splatlas
