#include "tests/reference/reference_picture.h"

#include <limits>
#include <stdexcept>

#include "player/shear.h"
#include "tests/reference/discrete_model.h"
#include "tests/reference/reference_surfaces.h"
#include "tests/reference/reference_volume.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What all renderers share.
struct Setup {
  ParallelView view;
  Axis principal;
  LightField field;

  explicit Setup(const ReferenceScene& scene)
      : view(view_of(scene)),
        principal(
            scene.options.principal_axis.value_or(factorise(view, storage_grid(scene.content)).principal)),
        field(light_field(scene.content, scene.selection, view, scene.options.hybrid_shading)) {}

  static ParallelView view_of(const ReferenceScene& scene) {
    const auto view = parallel_view(scene.camera, scene.options.size, scene.content.display);
    if (!view) throw std::runtime_error(view.error().message);
    return *view;
  }
};

template <typename PixelLight>
ReferencePicture render(const PictureSize& size, const PixelLight& light_of) {
  ReferencePicture picture{size, {}};
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const RayLight light = light_of(column, row);
      picture.pixels.push_back({light.color[0], light.color[1], light.color[2], 1 - light.transmittance});
    }
  }
  return picture;
}

/// The volume up to the first surface, the surface, the volume from there to the next one, and so on. The
/// volume between two depths is what is in front of the further one and not in front of the nearer one.
RayLight compose(const std::vector<Crossing>& crossings, const std::vector<RayLight>& volume_before) {
  RayLight sum;
  double through = 1;  // all surfaces so far
  RayLight nearer;
  for (std::size_t n = 0; n < volume_before.size(); ++n) {
    const RayLight& volume = volume_before[n];
    for (std::size_t c = 0; c < 3; ++c) sum.color[c] += through * (volume.color[c] - nearer.color[c]);
    sum.transmittance = through * volume.transmittance;
    nearer = volume;
    if (n == crossings.size()) break;
    for (std::size_t c = 0; c < 3; ++c) sum.color[c] += sum.transmittance * crossings[n].rgba[c];
    through *= 1 - crossings[n].rgba[3];
  }
  return sum;
}

ReferencePicture render_discrete(const ReferenceScene& scene, bool unlimited) {
  const Setup setup(scene);
  const int pixels_per_voxel = unlimited ? 0
                                         : sheet_pixels_per_voxel(scene.options.quality, setup.view,
                                                                  setup.field.grid, setup.principal);
  const DiscreteModel model(setup.field, setup.view, setup.principal, pixels_per_voxel);
  const SurfacesInView surfaces(scene.content, scene.selection, setup.view, setup.principal,
                                Coverage::kSnapped);
  return render(scene.options.size, [&](int column, int row) {
    const std::vector<Crossing> crossings = surfaces.crossings(column, row);
    if (crossings.empty() && !unlimited) return model.pixel_mean(column, row);
    std::vector<double> depths;
    for (const Crossing& crossing : crossings) depths.push_back(crossing.depth);
    return compose(crossings, model.at(column + 0.5, row + 0.5, depths));
  });
}

}  // namespace

ReferencePicture render_truth(const ReferenceScene& scene) {
  const Setup setup(scene);
  const SurfacesInView surfaces(scene.content, scene.selection, setup.view, setup.principal,
                                Coverage::kExact);
  return render(scene.options.size, [&](int column, int row) {
    const Ray ray = ray_through(setup.view, setup.field.grid, column + 0.5, row + 0.5);
    RayLight sum;
    double from_mm = -kInfinity;
    for (const Crossing& crossing : surfaces.crossings(column, row)) {
      sum.add(integrate_ray(setup.field, ray, from_mm, crossing.s_mm));
      sum.add_surface(crossing.rgba);
      from_mm = crossing.s_mm;
    }
    sum.add(integrate_ray(setup.field, ray, from_mm, kInfinity));
    return sum;
  });
}

ReferencePicture render_model(const ReferenceScene& scene) {
  return render_discrete(scene, false);
}
ReferencePicture render_slabs(const ReferenceScene& scene) {
  return render_discrete(scene, true);
}

}  // namespace splatlas::reference
