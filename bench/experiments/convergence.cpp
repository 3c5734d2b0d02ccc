#include "bench/experiments/convergence.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "bench/measure/frames.h"
#include "format/result_macros.h"
#include "player/render/rays/cast_rays.h"
#include "tests/reference/optical_field.h"
#include "tests/reference/picture_difference.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"
#include "tests/reference/reference_volume.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

using reference::ReferencePicture;

constexpr double kMaxGrey = 2;  // end of the transfer function
constexpr double kTruthStepMm = 0.05;

struct Blob {
  Vec3 center_mm;
  double width_mm;
};
constexpr std::array kBlobs{Blob{{-3, 2, -1}, 4}, Blob{{3, -3, 2}, 3.5}, Blob{{1, 4, 3}, 3},
                            Blob{{-2, -4, -4}, 3}};

/// Reach of the field: the corners of the cube.
const double kReachMm = 0.5 * std::sqrt(3.0) * kFieldSideMm;

reference::RayRadiance radiance_along(const Vec3& from_mm, const Vec3& direction, double length_mm) {
  reference::RayRadiance sum;
  const auto steps = static_cast<int>(std::ceil(length_mm / kTruthStepMm));
  const double step = length_mm / steps;
  for (int n = 0; n < steps; ++n) {
    Vec3 at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = from_mm[a] + (n + 0.5) * step * direction[a];
    const double grey = smooth_field(at);
    reference::RayRadiance slab;
    slab.transmittance = std::exp(-kFieldExtinctionPerMm * grey * step);
    const double shade = grey / kMaxGrey;
    slab.color.fill(shade * (1 - slab.transmittance));
    sum.add(slab);
  }
  return sum;
}

/// A close-up, in which every quality has its finest sheets on every grid: eight pixels per voxel of the
/// coarsest grid, four of the finest.
constexpr PictureSize kSize{40, 40};
constexpr double kMmPerPixel = 0.1875;
constexpr std::array kVoxelsMm{1.5, 1.0, 0.75};
/// Off all symmetries; principal axes z, y and x.
constexpr std::array<std::array<double, 2>, 3> kDirections{{{17, 62}, {25, 14}, {68, -21}}};

Camera camera_from(const std::array<double, 2>& direction, const Display& display,
                   CameraProjection projection) {
  return {.azimuth_deg = direction[0],
          .elevation_deg = direction[1],
          .zoom = zoom_for(display, kSize.width, kMmPerPixel),
          .center_lps_mm = Vec3{0.3, -0.2, 0.1},
          .projection = projection};
}

/// A renderer in the refinement of the grid.
struct GridRenderer {
  const char* name;
  CameraProjection projection;
  Classification classification;
  Quality quality;
};
constexpr std::array kGridRenderers{
    GridRenderer{"sheets, draft", CameraProjection::kParallel, Classification::kBefore, Quality::kDraft},
    GridRenderer{"sheets, normal", CameraProjection::kParallel, Classification::kBefore, Quality::kNormal},
    GridRenderer{"rays, parallel, high", CameraProjection::kParallel, Classification::kBefore,
                 Quality::kHigh},
    GridRenderer{"rays before, high", CameraProjection::kPerspective, Classification::kBefore,
                 Quality::kHigh},
    GridRenderer{"rays after, high", CameraProjection::kPerspective, Classification::kAfter, Quality::kHigh}};

/// One row per renderer.
Result<std::vector<Convergence>> refine_grid() {
  std::vector<Convergence> rows;
  for (const GridRenderer& ours : kGridRenderers) {
    rows.push_back({.refined = "grid, against the field itself", .renderer = ours.name});
  }
  for (const double voxel_mm : kVoxelsMm) {
    const AtlasContent content = sampled_field(voxel_mm);
    Renderer renderer(open_in_memory(content), {.threads = 0});
    SPLATLAS_RETURN_IF_ERROR(renderer.select(field_selection(content, voxel_mm)));
    std::array<double, kGridRenderers.size()> squares{};
    for (const auto& direction : kDirections) {
      for (const CameraProjection projection :
           {CameraProjection::kParallel, CameraProjection::kPerspective}) {
        const Camera camera = camera_from(direction, content.display, projection);
        SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, kSize, content.display));
        const ReferencePicture truth = field_truth(view);
        for (std::size_t n = 0; n < kGridRenderers.size(); ++n) {
          const GridRenderer& ours = kGridRenderers[n];
          if (ours.projection != projection) continue;
          const RenderOptions options{.size = kSize,
                                      .quality = ours.quality,
                                      .classification = ours.classification,
                                      .hybrid_shading = false,
                                      .termination_threshold = 0.0f};
          SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, renderer.render(camera, options));
          squares[n] += std::pow(difference(frame.picture, truth).rms, 2);
        }
      }
    }
    for (std::size_t n = 0; n < rows.size(); ++n) {
      rows[n].steps.push_back(voxel_mm);
      rows[n].errors.push_back(std::sqrt(squares[n] / static_cast<double>(kDirections.size())));
    }
  }
  return rows;
}

/// The volume of the ray caster.
Result<RayVolume> ray_volume(const std::shared_ptr<const Atlas>& atlas, const Selection& selection,
                             Classification classification, ThreadPool& pool) {
  SPLATLAS_ASSIGN_OR_RETURN(const DecodedVolumes decoded, decode_volumes(atlas, selection, Axis::kZ, pool));
  return RayVolume::build({.atlas = *atlas,
                           .selection = selection,
                           .plan = decoded.plan,
                           .appearances = decoded.appearances->appearances(),
                           .runs = *decoded.runs,
                           .cache = *decoded.cache,
                           .classification = classification,
                           .max_memory_bytes = std::uint64_t{1} << 30},
                          pool);
}

/// Ground truth of the trilinear field of the grid.
ReferencePicture grid_truth(const AtlasContent& content, const Selection& selection, const View& view,
                            const Camera& camera) {
  const reference::OpticalField field = reference::optical_field(content, selection, view.plane, false);
  ReferencePicture truth{kSize, {}};
  for (int n = 0; n < kSize.width * kSize.height; ++n) {
    const int column = n % kSize.width, row = n / kSize.width;
    const reference::Ray ray = ray_through(reference::PerspectiveView{view.plane, camera.field_of_view_deg},
                                           field.grid, column + 0.5, row + 0.5);
    truth.pixels.push_back(integrate_ray(field, ray, 0, std::numeric_limits<double>::infinity()).rgba());
  }
  return truth;
}

/// Doubles the steps without a tolerance, to isolate the order of the quadrature.
Result<Convergence> refine_steps() {
  Convergence row{.refined = "steps of a slab, against the grid's field", .renderer = "rays before"};
  constexpr double kVoxelMm = 1.5;
  const AtlasContent content = sampled_field(kVoxelMm);
  const Selection selection = field_selection(content, kVoxelMm);
  ThreadPool pool(0);
  const auto atlas = open_in_memory(content);
  SPLATLAS_ASSIGN_OR_RETURN(const RayVolume volume,
                            ray_volume(atlas, selection, Classification::kBefore, pool));
  const Camera camera = camera_from(kDirections[1], content.display, CameraProjection::kPerspective);
  SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(camera, kSize, content.display));
  const ReferencePicture truth = grid_truth(content, selection, view, camera);
  for (const int steps : {1, 2, 4, 8}) {
    Picture picture;
    cast_rays(volume, view, atlas->grid(), {.min_steps = steps, .max_steps = steps}, best_march(), picture,
              pool);
    row.steps.push_back(1.0 / steps);
    row.errors.push_back(reference::difference(picture, truth).rms);
  }
  return row;
}

}  // namespace

double smooth_field(const Vec3& at_mm) {
  double sum = 0;
  for (const Blob& blob : kBlobs) {
    double squares = 0;
    for (std::size_t a = 0; a < 3; ++a)
      squares += std::pow((at_mm[a] - blob.center_mm[a]) / blob.width_mm, 2);
    sum += std::exp(-0.5 * squares);
  }
  return sum;
}

AtlasContent sampled_field(double voxel_mm) {
  const auto side = static_cast<std::int64_t>(std::lround(kFieldSideMm / voxel_mm));
  const double first = 0.5 * (voxel_mm - kFieldSideMm);
  TestVolume volume;
  volume.grid = {
      {side, side, side}, {voxel_mm, voxel_mm, voxel_mm}, {first, first, first}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  std::vector<float> greys;
  volume.structures = {{"field", make_mask(volume.grid.size, [&](auto i, auto j, auto k) {
                          const auto mm = [&](auto n) { return first + voxel_mm * static_cast<double>(n); };
                          greys.push_back(static_cast<float>(smooth_field({mm(i), mm(j), mm(k)})));
                          return true;
                        })}};
  volume.values = make_values(VoxelType::kFloat32, greys);
  volume.window_high = kMaxGrey;
  return make_content(volume);
}

Selection field_selection(const AtlasContent& content, double voxel_mm) {
  const double opacity = -std::expm1(-kFieldExtinctionPerMm * kMaxGrey * voxel_mm);
  return selection_of(fmt::format("field:volume(color=#ffffff,curve=0:0:0/{}:{:.12f}:1)", kMaxGrey, opacity),
                      content.graph);
}

reference::ReferencePicture field_truth(const View& view) {
  const auto [width, height] = view.plane.size;
  reference::ReferencePicture truth{view.plane.size, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3 point = view.plane.point_lps_mm(x + 0.5, y + 0.5);
      Vec3 from = point;
      Vec3 direction = view.plane.forward_lps;
      double length = 2 * kReachMm;
      if (view.eye_mm) {
        from = view.eye_lps_mm();
        direction = reference::minus(point, from);
        const double to_plane = std::sqrt(reference::dot(direction, direction));
        for (double& part : direction) part /= to_plane;
        length = to_plane + kReachMm;
      } else {
        for (std::size_t a = 0; a < 3; ++a) from[a] -= kReachMm * direction[a];
      }
      truth.pixels.push_back(radiance_along(from, direction, length).rgba());
    }
  }
  return truth;
}

double observed_order(std::span<const double> steps, std::span<const double> errors) {
  double x_mean = 0, y_mean = 0;
  const auto count = static_cast<double>(steps.size());
  for (std::size_t n = 0; n < steps.size(); ++n) {
    x_mean += std::log(steps[n]) / count;
    y_mean += std::log(errors[n]) / count;
  }
  double xy = 0, xx = 0;
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const double x = std::log(steps[n]) - x_mean;
    xy += x * (std::log(errors[n]) - y_mean);
    xx += x * x;
  }
  return xy / xx;
}

Result<std::vector<Convergence>> measure_convergence() {
  SPLATLAS_ASSIGN_OR_RETURN(std::vector<Convergence> rows, refine_grid());
  SPLATLAS_ASSIGN_OR_RETURN(Convergence steps, refine_steps());
  rows.push_back(std::move(steps));
  return rows;
}

}  // namespace splatlas
