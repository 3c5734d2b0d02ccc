#include "player/render/rays/cast_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "format/tasks/task_control.h"
#include "player/render/clip/cut_faces.h"
#include "player/render/rays/pixel_rays.h"
#include "player/render/rays/ray_shares.h"
#include "player/render/view/view_frame.h"

namespace splatlas {
namespace {

constexpr int kTileSide = 32;  // pixels, the unit of work of a thread

/// Pixels of the picture.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;  // half-open
};

/// Bounding box of the pixels whose rays pass within one voxel of the volume.
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
    constexpr double kNear = 1e-3;  // the eye lies inside the box or close to it
    if (point.w < kNear) return all;
    left = std::min(left, point.x / point.w);
    right = std::max(right, point.x / point.w);
    top = std::min(top, point.y / point.w);
    bottom = std::max(bottom, point.y / point.w);
  }
  constexpr double kRounding = 1;
  const auto pixel = [](double at, int max) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(max)));
  };
  return {pixel(std::floor(left - kRounding), size.width), pixel(std::floor(top - kRounding), size.height),
          pixel(std::ceil(right + kRounding) + 1, size.width),
          pixel(std::ceil(bottom + kRounding) + 1, size.height)};
}

/// Finds the structures of a block of pixels.
void store_ids(int left, int top, const RayShares& shares, const CastOptions& options) {
  IdImage& ids = *options.ids;
  PixelShares sum;
  for (int row = top; row < std::min(top + kBlockSide, ids.size.height); ++row) {
    for (int column = left; column < std::min(left + kBlockSide, ids.size.width); ++column) {
      const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(ids.size.width) +
                         static_cast<std::size_t>(column);
      const PixelShares& volume =
          shares.of_ray(static_cast<std::size_t>((row - top) * kBlockSide + column - left));
      const RayFaces faces = options.faces != nullptr ? options.faces->at(pixel) : RayFaces{};
      sum.clear();
      if (faces.show()) sum.add_between(faces, volume, 1);
      ids.numbers[pixel] = faces.show() ? sum.largest() : volume.largest();
    }
  }
}

/// Ends the rays of a block of pixels at surfaces, and those behind opaque faces where they begin.
void end_rays(int left, int top, const PictureSize& size, const CastOptions& options, const Index3& first,
              RayPacket& packet) {
  for (int n = 0; n < kBlockSide * kBlockSide; ++n) {
    const int x = std::min(left + n % kBlockSide, size.width - 1);
    const int y = std::min(top + n / kBlockSide, size.height - 1);
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
    const auto ray = static_cast<std::size_t>(n);
    if (options.faces != nullptr && options.faces->hides(pixel)) packet.to[ray] = packet.from[ray];
    if (options.ends == nullptr) continue;
    const auto& [depths, scene] = *options.ends;
    const std::size_t axis = scene.depth_axis;
    const double place =
        scene.depth_sign * static_cast<double>(depths[pixel]) - static_cast<double>(first[axis]);
    packet.to[ray] = std::min(packet.to[ray], t_at(packet, ray, axis, place));
  }
}

/// Casts the rays of a block of pixels. `shares`: null without ids.
void render_block(int left, int top, const PixelRays& rays, const RayVolume& volume, const MarchScene& scene,
                  const CastOptions& options, const MarchKernels& kernels, RayShares* shares,
                  Picture& picture) {
  check_task();
  const RayPoints points = block_centers(left, top, picture.size);
  RayPacket packet = rays.through(points);
  if (options.cuts != nullptr) rays.clip(*options.cuts, points, packet);
  if (options.ends != nullptr || options.faces != nullptr)
    end_rays(left, top, picture.size, options, volume.first(), packet);
  RadiancePacket radiance;
  if (shares != nullptr) {
    shares->begin(packet);
    radiance.trace = shares->trace();
  }
  kernels.march(scene, packet, radiance);
  if (shares != nullptr) {
    shares->take();
    store_ids(left, top, *shares, options);
  }
  const int columns = std::min(kBlockSide, picture.size.width - left);
  const int rows = std::min(kBlockSide, picture.size.height - top);
  for (int row = 0; row < rows; ++row) {
    float* out =
        &picture
             .rgba[4 * (static_cast<std::size_t>(top + row) * static_cast<std::size_t>(picture.size.width) +
                        static_cast<std::size_t>(left))];
    for (int column = 0; column < columns; ++column) {
      const std::size_t n = static_cast<std::size_t>(row) * kBlockSide + static_cast<std::size_t>(column);
      // Without ends, the picture is empty
      const float transmittance = 1 - radiance.planes[3][n];
      for (std::size_t c = 0; c < 4; ++c, ++out) *out = radiance.planes[c][n] + transmittance * *out;
    }
  }
}

/// Casts the rays of all blocks that may show the volume.
void cast_blocks(const RayVolume& volume, const View& view, const Grid& grid, const CastOptions& options,
                 const MarchKernels& kernels, Picture& picture, ThreadPool& pool) {
  const PixelRays rays(view, grid, volume.first(), options.principal_axis);
  const MarchScene scene = march_scene(volume, options);
  const PixelBox shown = shown_box(volume, view, grid);
  const int columns = (shown.right - shown.left + kTileSide - 1) / kTileSide;
  const int rows = (shown.bottom - shown.top + kTileSide - 1) / kTileSide;
  if (columns <= 0 || rows <= 0) return;
  pool.for_each(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t n) {
    const int left = shown.left + static_cast<int>(n % static_cast<std::size_t>(columns)) * kTileSide;
    const int top = shown.top + static_cast<int>(n / static_cast<std::size_t>(columns)) * kTileSide;
    const int right = std::min(left + kTileSide, shown.right);
    const int bottom = std::min(top + kTileSide, shown.bottom);
    std::optional<RayShares> shares;
    if (options.ids != nullptr) shares.emplace(volume);
    for (int y = top; y < bottom; y += kBlockSide) {
      for (int x = left; x < right; x += kBlockSide)
        render_block(x, y, rays, volume, scene, options, kernels, shares ? &*shares : nullptr, picture);
    }
  });
}

/// Clears the ids, or begins with those of faces alone.
void begin_ids(const PictureSize& size, const FaceLayer* faces, IdImage& ids) {
  ids.size = size;
  ids.numbers.assign(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height), 0);
  if (faces == nullptr) return;
  for (std::size_t n = 0; n < ids.numbers.size(); ++n) {
    const RayFaces of_pixel = faces->at(n);
    if (!of_pixel.show()) continue;
    PixelShares sum;
    sum.add_between(of_pixel, {}, 1);
    ids.numbers[n] = sum.largest();
  }
}

}  // namespace

MarchScene march_scene(const RayVolume& volume, const CastOptions& options) {
  return {.grid = volume.grid(),
          .sources = volume.sources(),
          .active = volume.active(),
          .termination_threshold = options.termination_threshold,
          .min_steps = options.min_steps,
          .max_steps = options.max_steps,
          .tolerance = options.tolerance};
}

void cast_rays(const RayVolume& volume, const View& view, const Grid& grid, const CastOptions& options,
               const MarchKernels& kernels, Picture& picture, ThreadPool& pool) {
  const PictureSize size = view.plane.size;
  picture.size = size;
  if (options.ends == nullptr)
    picture.rgba.assign(4 * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height),
                        0.0f);
  if (options.ids != nullptr) begin_ids(size, options.faces, *options.ids);
  if (!volume.empty()) cast_blocks(volume, view, grid, options, kernels, picture, pool);
  if (options.faces != nullptr) add_faces(*options.faces, picture, pool);
}

}  // namespace splatlas
