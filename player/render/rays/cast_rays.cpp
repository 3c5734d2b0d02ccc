#include "player/render/rays/cast_rays.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "format/tasks/task_control.h"
#include "player/render/clip/cut_faces.h"

namespace splatlas {
namespace {

constexpr int kTileRays = 32;  // the unit of work of a thread, along each axis

/// Bounding box of the pixels whose rays pass within one voxel of the volume.
PixelBox shown_box(const RayVolume& volume, const View& view, const Grid& grid) {
  const PictureSize& size = view.plane.size;
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
    if (point.w < kNear) return PixelBox::of(size);
    left = std::min(left, point.x / point.w);
    right = std::max(right, point.x / point.w);
    top = std::min(top, point.y / point.w);
    bottom = std::max(bottom, point.y / point.w);
  }
  constexpr double kRounding = 1;
  const auto pixel = [](double at, int max) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(max)));
  };
  return {pixel(std::floor(left - kRounding), size.width),
          pixel(std::ceil(right + kRounding) + 1, size.width) - 1,
          pixel(std::floor(top - kRounding), size.height),
          pixel(std::ceil(bottom + kRounding) + 1, size.height) - 1};
}

/// Casts the rays of blocks of pixels. Not thread-safe.
class BlockCaster {
 public:
  /// References must outlive this object.
  BlockCaster(const RayVolume& volume, const PixelRays& rays, const MarchScene& scene,
              const CastOptions& options, const MarchKernels& kernels, const PictureSize& size,
              const ViewDepth& view_depth, Picture* picture)
      : volume_(volume),
        rays_(rays),
        scene_(scene),
        options_(options),
        kernels_(kernels),
        size_(size),
        view_depth_(view_depth),
        picture_(picture) {
    if (options.ids != nullptr || options.depths != nullptr) shares_.emplace(volume);
  }

  void render(int left, int top) {
    const RayBlock block{left, top, options_.rays};
    rgba_ = {};
    for (PixelShares& shares : of_pixels_) shares.clear();
    for (int packet = 0; packet < block.grid.count(); ++packet) cast(block, packet);
    const float weight = 1.0f / static_cast<float>(block.grid.count());
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const int x = left + static_cast<int>(n) % kBlockSide, y = top + static_cast<int>(n) / kBlockSide;
      if (x >= size_.width || y >= size_.height) continue;
      const std::size_t pixel = size_.pixel(x, y);
      // Without ends, the picture is empty
      const float transmittance = 1 - weight * rgba_[n][3];
      for (std::size_t c = 0; picture_ != nullptr && c < 4; ++c) {
        float& out = picture_->rgba[4 * pixel + c];
        out = weight * rgba_[n][c] + transmittance * out;
      }
      if (options_.ids != nullptr) store_id(pixel, of_pixels_[n], weight);
    }
    if (options_.depths == nullptr) return;
    if (block.grid.count() > 1) cast({left, top}, 0);  // through the centres
    for (std::size_t n = 0; n < kPacketRays; ++n) store_depth(left, top, n);
  }

 private:
  void cast(const RayBlock& block, int number) {
    check_task();
    const RayPoints points = block.points(number, size_);
    packet_ = rays_.through(points);
    if (options_.cuts != nullptr) rays_.clip(*options_.cuts, points, packet_);
    if (options_.ends != nullptr || options_.faces != nullptr) end(points, packet_);
    RadiancePacket radiance;
    if (shares_) {
      shares_->begin(packet_);
      radiance.trace = shares_->trace();
    }
    kernels_.march(scene_, packet_, radiance);
    if (shares_) shares_->take();
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const std::size_t pixel = block.pixel(number, n);
      for (std::size_t c = 0; c < 4; ++c) rgba_[pixel][c] += radiance.planes[c][n];
      if (shares_) of_pixels_[pixel].add(shares_->of_ray(n), 1);
    }
  }

  /// Ends the rays of a packet at surfaces, and those behind opaque faces where they begin.
  void end(const RayPoints& points, RayPacket& packet) const {
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const std::size_t pixel = size_.pixel(static_cast<int>(points.x[n]), static_cast<int>(points.y[n]));
      if (options_.faces != nullptr && options_.faces->hides(pixel)) packet.to[n] = packet.from[n];
      if (options_.ends == nullptr) continue;
      const auto& [depths, scene] = *options_.ends;
      const std::size_t axis = scene.depth_axis;
      const double place =
          scene.depth_sign * static_cast<double>(depths[pixel]) - static_cast<double>(volume_.first()[axis]);
      packet.to[n] = std::min(packet.to[n], t_at(packet, n, axis, place));
    }
  }

  /// Finds the structure of a pixel. `volume`: sums over its rays.
  void store_id(std::size_t pixel, const PixelShares& volume, float weight) {
    StructureNumber& number = options_.ids->numbers[pixel];
    const RayFaces faces = options_.faces != nullptr ? options_.faces->at(pixel) : RayFaces{};
    number = volume.largest();
    if (!faces.show()) return;
    mean_.clear();
    mean_.add(volume, weight);
    sum_.clear();
    sum_.add_between(faces, mean_, 1);
    number = sum_.largest();
  }

  /// Merges the depth of the latest packet's n-th ray, which is through the centre of its pixel.
  void store_depth(int left, int top, std::size_t n) const {
    const int x = left + static_cast<int>(n) % kBlockSide, y = top + static_cast<int>(n) / kBlockSide;
    if (x >= size_.width || y >= size_.height || std::isinf(shares_->depth_of_ray(n))) return;
    const std::size_t axis = principal_axis_of(packet_, n);
    const double index = static_cast<double>(packet_.step[axis][n] * shares_->depth_of_ray(n)) +
                         static_cast<double>(volume_.first()[axis]);
    float& mm = options_.depths->mm[size_.pixel(x, y)];
    mm = std::min(mm, static_cast<float>(view_depth_.mm(x + 0.5, y + 0.5, axis, index)));
  }

  const RayVolume& volume_;
  const PixelRays& rays_;
  const MarchScene& scene_;
  const CastOptions& options_;
  const MarchKernels& kernels_;
  PictureSize size_;
  const ViewDepth& view_depth_;
  Picture* picture_;
  std::optional<RayShares> shares_;  // with ids or depths
  RayPacket packet_;                 // the latest
  // Of the pixels of the current block: sums over their rays
  std::array<std::array<float, 4>, kPacketRays> rgba_{};
  std::array<PixelShares, kPacketRays> of_pixels_;
  PixelShares mean_, sum_;
};

/// Casts the rays of all blocks that may show the volume.
void cast_blocks(const RayVolume& volume, const View& view, const Grid& grid, const CastOptions& options,
                 const MarchKernels& kernels, Picture* picture, ThreadPool& pool) {
  const PixelRays rays(view, grid, volume.first(), options.principal_axis);
  const MarchScene scene = march_scene(volume, options);
  const ViewDepth view_depth(view, grid);
  const PixelBox shown = shown_box(volume, view, grid);
  const auto side = [](int of_pixel) { return std::max(kTileRays / of_pixel / kBlockSide, 1) * kBlockSide; };
  const int width = side(options.rays.columns), height = side(options.rays.rows);  // of a tile
  const int columns = (shown.width() + width - 1) / width;
  const int rows = (shown.height() + height - 1) / height;
  if (columns <= 0 || rows <= 0) return;
  pool.for_each(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t n) {
    const int left = shown.x_first + static_cast<int>(n % static_cast<std::size_t>(columns)) * width;
    const int top = shown.y_first + static_cast<int>(n / static_cast<std::size_t>(columns)) * height;
    const int right = std::min(left + width, shown.x_last + 1);
    const int bottom = std::min(top + height, shown.y_last + 1);
    BlockCaster caster(volume, rays, scene, options, kernels, view.plane.size, view_depth, picture);
    for (int y = top; y < bottom; y += kBlockSide) {
      for (int x = left; x < right; x += kBlockSide) caster.render(x, y);
    }
  });
}

/// Clears the ids, or begins with those of faces alone.
void begin_ids(const PictureSize& size, const FaceLayer* faces, IdImage& ids) {
  ids.size = size;
  ids.numbers.assign(size.pixels(), 0);
  if (faces == nullptr) return;
  for (std::size_t n = 0; n < ids.numbers.size(); ++n) {
    const RayFaces of_pixel = faces->at(n);
    if (!of_pixel.show()) continue;
    PixelShares sum;
    sum.add_between(of_pixel, {}, 1);
    ids.numbers[n] = sum.largest();
  }
}

constexpr float kOpaque = 1e-6f;  // rounding error of a transmittance

/// Position of opacity one half in a step of constant extinction, given the opacities at its ends.
float half_of(float from, float to, float before, float behind) {
  const float share = std::log(2 * (1 - before)) / std::log((1 - before) / std::max(1 - behind, kOpaque));
  return from + share * (to - from);
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
               const MarchKernels& kernels, Picture* picture, ThreadPool& pool) {
  const PictureSize size = view.plane.size;
  if (picture != nullptr) picture->size = size;
  if (picture != nullptr && options.ends == nullptr) picture->rgba.assign(4 * size.pixels(), 0.0f);
  if (options.ids != nullptr) begin_ids(size, options.faces, *options.ids);
  if (!volume.empty()) cast_blocks(volume, view, grid, options, kernels, picture, pool);
  if (picture != nullptr && options.faces != nullptr) add_faces(*options.faces, *picture, pool);
}

RayShares::RayShares(const RayVolume& volume) : volume_(volume) {
  trace_.owner = this;
  trace_.take = [](MarchTrace& trace) { static_cast<Trace&>(trace).owner->take(); };
  if (volume.empty()) return;
  numbers_ = volume.numbers();
  cells_ = volume.cell_numbers();
  if (volume.classification() == Classification::kBefore) extinctions_ = volume.extinctions();
  const auto& size = volume.grid().size;
  const std::size_t row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
  for (std::size_t n = 0; n < 8; ++n)
    corners_[n] = (n & 1) + ((n & 2) != 0 ? row : 0) + ((n & 4) != 0 ? slice : 0);
}

void RayShares::begin(const RayPacket& rays) {
  rays_ = &rays;
  seen_.fill(0);
  depths_.fill(std::numeric_limits<float>::infinity());
  for (PixelShares& shares : shares_) shares.clear();
  trace_.count = 0;
}

void RayShares::take() {
  for (std::size_t n = 0; n < trace_.count; ++n) {
    const MarchTrace::Step& step = trace_.steps[n];
    for (std::size_t ray = 0; ray < kPacketRays; ++ray) {
      const float before = seen_[ray], behind = step.opacity[ray], rise = behind - before;
      if (!(rise > 0)) continue;
      seen_[ray] = behind;
      if (before < 0.5f && behind >= 0.5f)
        depths_[ray] = half_of(step.from[ray], step.to[ray], before, behind);
      if (cells_ != nullptr) add(ray, rise, 0.5f * (step.from[ray] + step.to[ray]));
    }
  }
  trace_.count = 0;
}

void RayShares::add_fragment(std::size_t ray, StructureIndex structure, float opacity) {
  if (opacity > seen_[ray]) shares_[ray].add(number_of(structure), opacity - seen_[ray]);
  seen_[ray] = opacity;
}

void RayShares::add(std::size_t ray, float rise, float t) {
  // Find the cell
  const auto& size = volume_.grid().size;
  std::array<std::int32_t, 3> cell{};
  std::array<float, 3> part{};
  for (std::size_t a = 0; a < 3; ++a) {
    const float at =
        std::clamp(rays_->origin[a][ray] + t * rays_->step[a][ray], 0.0f, static_cast<float>(size[a] - 2));
    cell[a] = static_cast<std::int32_t>(at);
    part[a] = at - static_cast<float>(cell[a]);
  }
  const std::size_t first = (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(size[1]) +
                             static_cast<std::size_t>(cell[1])) *
                                static_cast<std::size_t>(size[0]) +
                            static_cast<std::size_t>(cell[0]);

  const StructureNumber one = cells_[first];
  if (one == 0) return;
  if (one != RayVolume::kSeveralNumbers) return shares_[ray].add(one, rise);

  // Divide the opacity
  const StructureNumber* const numbers = numbers_ + first;
  std::array<float, 8> weights{};
  float sum = 0;
  for (std::size_t n = 0; n < 8; ++n) {
    if (numbers[corners_[n]] == 0) continue;
    float weight = extinctions_ == nullptr ? 1 : extinctions_[volume_.voxel_floats() * (first + corners_[n])];
    for (std::size_t a = 0; a < 3; ++a) weight *= (n >> a & 1) != 0 ? part[a] : 1 - part[a];
    weights[n] = weight;
    sum += weight;
  }
  if (!(sum > 0)) return;
  for (std::size_t n = 0; n < 8; ++n) {
    if (weights[n] > 0) shares_[ray].add(numbers[corners_[n]], rise * weights[n] / sum);
  }
}

}  // namespace splatlas
