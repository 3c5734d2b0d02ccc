
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "player/render/rays/cast_rays.h"
#include "player/render/view/shear.h"

namespace splatlas {
namespace {

constexpr std::size_t kRaysPerJob = 256;

/// The rays of up to kPacketRays samples, with the radiance composited so far. Where a pixel has several
/// rays, those of a sample are spread over its part of the pixel, and meet its fragments at their depths.
class SamplePacket {
 public:
  /// `shares`: null without ids.
  SamplePacket(const RayVolume& volume, const MarchScene& march, const MarchKernels& kernels,
               const FragmentList& list, std::size_t first, RayShares* shares)
      : volume_(volume),
        march_(march),
        kernels_(kernels),
        list_(list),
        shares_(shares),
        first_(first),
        count_(std::min(kPacketRays, list.sample_count() - first)) {}

  /// The rays of each sample, given those of a pixel: half of them along each axis if it has several samples.
  [[nodiscard]] RayGrid rays_of_samples(const RayGrid& of_pixel) const {
    double part = 0;
    for (std::size_t n = 0; n < count_; ++n) part = std::max(part, part_of_pixel(n));
    if (part == 0) return {};
    if (part == 1) return of_pixel;
    return {(of_pixel.columns + 1) / 2, (of_pixel.rows + 1) / 2};
  }
  /// Composites a ray of each sample, given its number in their grid.
  void render(const PixelRays& rays, const CutRays* cuts, int width, const RasterScene& scene,
              const RayGrid& grid, int number) {
    const int column = number % grid.columns, row = number / grid.columns;
    const double right = (column + 0.5) / grid.columns - 0.5, down = (row + 0.5) / grid.rows - 0.5;
    RayPoints points;
    for (std::size_t n = 0; n < kPacketRays; ++n) {
      const std::size_t of = std::min(n, count_ - 1);
      const Sample& sample = list_.samples[first_ + of];
      points.x[n] = sample.x(width) + part_of_pixel(of) * right;
      points.y[n] = sample.y(width) + part_of_pixel(of) * down;
    }
    radiance_ = {};
    packet_ = rays.through(points);
    if (cuts != nullptr) rays.clip(*cuts, points, packet_);
    if (shares_ != nullptr) {
      shares_->begin(packet_);
      radiance_.trace = shares_->trace();
    }
    for (std::size_t n = 0; n < count_; ++n) {
      if (is_hidden(n)) packet_.to[n] = packet_.from[n];
    }
    end_ = packet_.to;
    for (std::size_t n = count_; n < kPacketRays; ++n) end_[n] = packet_.from[n];
    std::size_t layers = 0;
    for (std::size_t n = 0; n < count_; ++n) {
      layers = std::max(layers, list_.of_sample(first_ + n).size());
    }
    for (std::size_t layer = 0; layer < layers; ++layer) pass_layer(layer, scene);
    march_to(end_);
  }
  /// Radiance of the latest ray of a sample, faces included.
  [[nodiscard]] Radiance radiance(std::size_t n) const {
    Radiance radiance;
    for (std::size_t c = 0; c < 4; ++c) radiance.rgba[c] = radiance_.planes[c][n];
    if (!list_.faces.empty()) radiance.rgba = list_.faces[first_ + n].around(radiance.rgba);
    return radiance;
  }
  /// The same for shares of structures.
  void add_shares(std::size_t n, float weight, PixelShares& sum) const {
    sum.add_between(list_.faces.empty() ? RayFaces{} : list_.faces[first_ + n], shares_->of_ray(n), weight);
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  /// Side of the part of a pixel whose rays a sample stands for. Patterns of several samples spare the
  /// centre. Opaque surfaces hide what lies close behind them along one ray only.
  [[nodiscard]] double part_of_pixel(std::size_t n) const {
    const auto fragments = list_.of_sample(first_ + n);
    if (!fragments.empty() && fragments.back().rgba[3] >= 1) return 0;
    const SubPixel& place = list_.samples[first_ + n].place;
    return place.x == 0 && place.y == 0 ? 1 : 0.5;
  }

  /// Composites the volume up to the next fragment of every ray, and the fragment.
  void pass_layer(std::size_t layer, const RasterScene& scene) {
    auto to = packet_.from;
    for (std::size_t n = 0; n < count_; ++n) {
      const auto fragments = list_.of_sample(first_ + n);
      if (layer < fragments.size() && !is_hidden(n))
        to[n] = std::max(to[n], std::min(end_[n], t_of(fragments[layer].depth, scene, n)));
    }
    march_to(to);
    for (std::size_t n = 0; n < count_; ++n) {
      const auto fragments = list_.of_sample(first_ + n);
      if (layer >= fragments.size()) continue;
      const float transmittance = 1 - radiance_.planes[3][n];
      for (std::size_t c = 0; c < 4; ++c) radiance_.planes[c][n] += transmittance * fragments[layer].rgba[c];
      if (shares_ != nullptr) shares_->add_fragment(n, fragments[layer].structure, radiance_.planes[3][n]);
      if (fragments[layer].rgba[3] >= 1) end_[n] = packet_.from[n];  // opaque
    }
  }

  /// True behind an opaque face.
  [[nodiscard]] bool is_hidden(std::size_t n) const {
    return !list_.faces.empty() && list_.faces[first_ + n].front.rgba[3] >= 1;
  }

  void march_to(const std::array<float, kPacketRays>& to) {
    packet_.to = to;
    if (!volume_.empty()) kernels_.march(march_, packet_, radiance_);
    if (shares_ != nullptr) shares_->take();
    packet_.from = to;
  }

  [[nodiscard]] float t_of(float depth, const RasterScene& scene, std::size_t n) const {
    const std::size_t axis = scene.depth_axis;
    return t_at(packet_, n, axis, scene.depth_sign * depth - static_cast<double>(volume_.first()[axis]));
  }

  const RayVolume& volume_;
  const MarchScene& march_;
  const MarchKernels& kernels_;
  const FragmentList& list_;
  RayShares* shares_;
  std::size_t first_, count_;
  RayPacket packet_;
  RadiancePacket radiance_;
  std::array<float, kPacketRays> end_{};
};

tl::unexpected<Error> too_wide(const View& view) {
  const double half_height_mm = 0.5 * view.plane.size.height * view.plane.mm_per_pixel;
  const double degrees = 360 / std::numbers::pi * std::atan(half_height_mm / *view.eye_mm);
  return bad_camera(
      "field of view",
      fmt::format("{:.6g} is too wide for surfaces from this direction; make it narrower, or select volumes "
                  "only, without external surfaces, which every mode draws",
                  degrees));
}

}  // namespace

Result<RasterScene> raster_scene_of_rays(std::span<const SurfaceDraw> surfaces, const View& view,
                                         const Grid& grid, const Lighting& lighting) {
  RasterScene scene = raster_scene(surfaces, view.plane, factorise(view.plane, grid), grid, lighting);
  if (!view.eye_mm || surfaces.empty()) return scene;
  scene.projection = Projection(view.plane, grid, *view.eye_mm);
  const std::optional<DepthAxis> depth = depth_axis(view, grid);
  if (!depth) return too_wide(view);
  scene.depth_axis = depth->axis;
  scene.depth_sign = depth->sign;
  const Vec3 along = lps_mm_to_index(grid).apply_linear(view.plane.forward_lps);
  scene.pixel_voxels = static_cast<float>(view.plane.mm_per_pixel * std::abs(along[depth->axis]));
  return scene;
}

void cast_surfaces(const RayVolume& volume, const View& view, const Grid& grid, const RasterScene& scene,
                   const FragmentList& fragments, const CastOptions& options, const MarchKernels& kernels,
                   Picture* picture, ThreadPool& pool) {
  const std::size_t samples = fragments.sample_count();
  if (samples == 0) return;
  const PixelRays rays(view, grid, volume.first(), options.principal_axis);
  const MarchScene march = march_scene(volume, options);
  std::vector<Radiance> radiances(samples);
  std::vector<PixelShares> shares(options.ids != nullptr ? samples : 0);
  const std::size_t packets =
      std::max<std::size_t>(kRaysPerJob / kPacketRays / static_cast<std::size_t>(options.rays.count()), 1);
  const std::size_t at_once = packets * kPacketRays;
  pool.for_each((samples + at_once - 1) / at_once, [&](std::size_t job) {
    const std::size_t last = std::min(samples, (job + 1) * at_once);
    std::optional<RayShares> of_packet;
    if (options.ids != nullptr) of_packet.emplace(volume);
    for (std::size_t first = job * at_once; first < last; first += kPacketRays) {
      check_task();
      SamplePacket packet(volume, march, kernels, fragments, first, of_packet ? &*of_packet : nullptr);
      const RayGrid of_sample = packet.rays_of_samples(volume.empty() ? RayGrid{} : options.rays);
      const float weight = 1.0f / static_cast<float>(of_sample.count());
      for (int ray = 0; ray < of_sample.count(); ++ray) {
        packet.render(rays, options.cuts, view.plane.size.width, scene, of_sample, ray);
        for (std::size_t n = 0; n < packet.count(); ++n) {
          radiances[first + n] += packet.radiance(n);
          if (of_packet) packet.add_shares(n, weight, shares[first + n]);
        }
      }
      for (std::size_t n = 0; n < packet.count(); ++n) {
        for (float& value : radiances[first + n].rgba) value *= weight;
      }
    }
  });
  for (std::size_t first = 0; first < samples;) {
    const std::uint32_t pixel = fragments.samples[first].pixel;
    std::size_t last = first;
    Radiance sum;
    for (; last < samples && fragments.samples[last].pixel == pixel; ++last) sum += radiances[last];
    for (std::size_t c = 0; picture != nullptr && c < 4; ++c) {
      picture->rgba[4 * std::size_t{pixel} + c] = sum.rgba[c] / static_cast<float>(last - first);
    }
    if (options.ids != nullptr) {
      for (std::size_t n = first + 1; n < last; ++n) shares[first].add(shares[n], 1);
      options.ids->numbers[pixel] = shares[first].largest();
    }
    first = last;
  }
}

}  // namespace splatlas
