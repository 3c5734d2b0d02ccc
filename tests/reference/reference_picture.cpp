#include "tests/reference/reference_picture.h"

#include <limits>
#include <stdexcept>

#include "player/render/view/shear.h"
#include "tests/reference/discrete_model.h"
#include "tests/reference/reference_cut.h"
#include "tests/reference/reference_surfaces.h"
#include "tests/reference/reference_volume.h"

namespace splatlas::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Setup shared by all reference renderers.
struct Setup {
  ParallelView view;
  Axis principal;
  OpticalField field;
  ReferenceCut cut;

  explicit Setup(const ReferenceScene& scene)
      : view(view_of(scene)),
        principal(factorise(view, storage_grid(scene.content)).principal),
        field(optical_field(scene.content, scene.selection, view, scene.options.hybrid_shading)),
        cut(scene.content, scene.selection, scene.options) {}

  /// Composites the radiance between the faces of the cut with them.
  [[nodiscard]] RayRadiance between_faces(const RayRadiance& radiance, double x, double y) const {
    if (cut.empty()) return radiance;
    const Ray ray = ray_through(view, field.grid, x, y);
    const KeptRay kept = cut.clip(ray, -kInfinity);
    RayRadiance sum;
    sum.add_surface(cut.front(ray, kept).rgba);
    sum.add(radiance);
    sum.add_surface(cut.back(ray, kept).rgba);
    return sum;
  }

  static ParallelView view_of(const ReferenceScene& scene) {
    const auto view = parallel_view(scene.camera, scene.options.size, scene.content.display);
    if (!view) throw std::runtime_error(view.error().message);
    return *view;
  }
};

template <typename PixelRadiance>
ReferencePicture render(const PictureSize& size, const PixelRadiance& radiance_of) {
  ReferencePicture picture{size, {}};
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column)
      picture.pixels.push_back(radiance_of(column, row).rgba());
  }
  return picture;
}

/// Composites surfaces and the volume between them, front to back. The volume between two depths is the
/// difference of the volumes in front of them.
RayRadiance compose(const std::vector<Crossing>& crossings, const std::vector<RayRadiance>& volume_before) {
  RayRadiance sum;
  double transmittance = 1;  // of all surfaces so far
  RayRadiance nearer;
  for (std::size_t n = 0; n < volume_before.size(); ++n) {
    const RayRadiance& volume = volume_before[n];
    for (std::size_t c = 0; c < 3; ++c) sum.color[c] += transmittance * (volume.color[c] - nearer.color[c]);
    sum.transmittance = transmittance * volume.transmittance;
    nearer = volume;
    if (n == crossings.size()) break;
    for (std::size_t c = 0; c < 3; ++c) sum.color[c] += sum.transmittance * crossings[n].rgba[c];
    transmittance *= 1 - crossings[n].rgba[3];
  }
  return sum;
}

/// The discrete model of volume and surfaces at picture coordinates.
class DiscreteScene {
 public:
  DiscreteScene(const ReferenceScene& scene, bool unlimited)
      : setup_(scene),
        unlimited_(unlimited),
        model_(setup_.field, setup_.view, setup_.principal,
               unlimited ? 0
                         : sheet_pixels_per_voxel(scene.options.quality, setup_.view, setup_.field,
                                                  setup_.principal),
               slabs_per_slice(scene.options.quality), setup_.cut.empty() ? nullptr : &setup_.cut),
        surfaces_(scene.content, scene.selection, setup_.view, setup_.principal, Coverage::kSnapped) {}

  [[nodiscard]] RayRadiance at(double x, double y) const { return compose_at(crossings(x, y), x, y); }
  /// Without surfaces and with a finite sheet, means over pixels.
  [[nodiscard]] ReferencePicture picture() const {
    return render(setup_.view.size, [&](int column, int row) {
      const double x = column + 0.5, y = row + 0.5;
      const std::vector<Crossing> at_center = crossings(x, y);
      if (at_center.empty() && !unlimited_) return setup_.between_faces(model_.pixel_mean(column, row), x, y);
      return compose_at(at_center, x, y);
    });
  }

 private:
  [[nodiscard]] RayRadiance compose_at(const std::vector<Crossing>& crossings, double x, double y) const {
    std::vector<double> depths;
    for (const Crossing& crossing : crossings) depths.push_back(crossing.depth);
    return setup_.between_faces(compose(crossings, model_.at(x, y, depths)), x, y);
  }
  [[nodiscard]] std::vector<Crossing> crossings(double x, double y) const {
    const Ray ray = ray_through(setup_.view, setup_.field.grid, x, y);
    return surfaces_.crossings(x, y, setup_.cut.surfaces(ray, -kInfinity));
  }

  Setup setup_;
  bool unlimited_;
  DiscreteModel model_;
  SurfacesInView surfaces_;
};

RayRadiance truth_at(const Setup& setup, const SurfacesInView& surfaces, double x, double y) {
  const Ray ray = ray_through(setup.view, setup.field.grid, x, y);
  RayRadiance sum;
  const KeptRay kept = setup.cut.clip(ray, -kInfinity);
  if (kept.empty()) return sum;
  double from_mm = kept.from_mm;
  for (const Crossing& crossing : surfaces.crossings(x, y, setup.cut.surfaces(ray, -kInfinity))) {
    sum.add(integrate_ray(setup.field, ray, from_mm, crossing.s_mm));
    sum.add_surface(crossing.rgba);
    from_mm = crossing.s_mm;
  }
  sum.add(integrate_ray(setup.field, ray, from_mm, kept.to_mm));
  return setup.between_faces(sum, x, y);
}

}  // namespace

ReferencePicture render_truth(const ReferenceScene& scene) {
  return render_mean_truth(scene, 1);
}

ReferencePicture render_mean_truth(const ReferenceScene& scene, int columns, int rows) {
  const Setup setup(scene);
  const SurfacesInView surfaces(scene.content, scene.selection, setup.view, setup.principal,
                                Coverage::kExact);
  return render(scene.options.size, [&](int column, int row) {
    RayRadiance mean{{0, 0, 0}, 0};
    for (int place = 0; place < columns * rows; ++place) {
      const double x = column + (place % columns + 0.5) / columns;
      const double y = row + (place / columns + 0.5) / rows;
      mean.add_weighted(1.0 / (columns * rows), truth_at(setup, surfaces, x, y));
    }
    return mean;
  });
}

ReferencePicture render_model(const ReferenceScene& scene) {
  return DiscreteScene(scene, false).picture();
}
ReferencePicture render_model(const ReferenceScene& scene, std::span<const SubPixel> places) {
  const DiscreteScene discrete(scene, false);
  return render(scene.options.size, [&](int column, int row) {
    RayRadiance mean{{0, 0, 0}, 0};
    for (const SubPixel& place : places) {
      mean.add_weighted(1.0 / static_cast<double>(places.size()),
                        discrete.at(column + place.right(), row + place.down()));
    }
    return mean;
  });
}
ReferencePicture render_slabs(const ReferenceScene& scene) {
  return DiscreteScene(scene, true).picture();
}

}  // namespace splatlas::reference
