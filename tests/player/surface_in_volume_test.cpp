// Surfaces inside a volume, composited at their exact depths.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "player/render/view/shear.h"
#include "tests/reference/discrete_model.h"
#include "tests/reference/reference_radiance.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

constexpr std::int64_t kDepth = 9;    // fog along y, voxels
constexpr std::int64_t kWidth = 35;   // along x and z
constexpr float kFogOpacity = 0.15f;  // per voxel
constexpr Rgb kFogColor{180, 200, 220};

/// A plane y = `at` across the fog.
struct Plane {
  double at = 0;
  Rgb color{};
  float opacity = 0.5f;
  bool faces_viewer = true;
};

/// Fog in every voxel, and structures for `surfaces` surfaces.
AtlasContent content_for(std::size_t surfaces) {
  TestVolume volume;
  volume.grid.size = {kWidth, kDepth, kWidth};
  volume.structures = {{"fog", full_mask(volume.grid.size), kFogColor}};
  for (std::size_t n = 0; n < surfaces; ++n) {
    // The player ignores which voxels lead to a surface.
    const auto mask =
        make_mask(volume.grid.size, [n](auto i, auto, auto) { return i == static_cast<std::int64_t>(n); });
    volume.structures.push_back({fmt::format("plane{}", n), mask});
  }
  return make_content(volume);
}

/// Fog in every voxel, and one surface per plane.
AtlasContent fog_content(const std::vector<Plane>& planes) {
  static std::map<std::size_t, AtlasContent> contents;
  if (!contents.contains(planes.size())) contents.emplace(planes.size(), content_for(planes.size()));
  AtlasContent content = contents.at(planes.size());
  for (std::size_t n = 0; n < planes.size(); ++n) {
    SurfaceMesh& mesh = content.surfaces[n + 1];
    const float last = static_cast<float>(kWidth) - 1;
    const auto y = static_cast<float>(planes[n].at);
    mesh = {};
    mesh.position_scale = 4096;
    mesh.positions_ijk = {{0, y, 0}, {last, y, 0}, {last, y, last}, {0, y, last}};
    mesh.normals_lps.assign(4, {0, planes[n].faces_viewer ? -1.0f : 1.0f, 0});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  }
  return content;
}

Selection fog_selection(const std::vector<Plane>& planes) {
  Selection selection;
  selection.structures.resize(planes.size() + 1);
  selection.structures[0] = {DrawMode::kVolume, kFogOpacity, kFogColor, 9};
  for (std::size_t n = 0; n < planes.size(); ++n) {
    selection.structures[n + 1] = {DrawMode::kSurface, planes[n].opacity, planes[n].color, 0};
  }
  return selection;
}

struct FogView {
  Camera camera;
  RenderOptions options{.size = {7, 7}, .hybrid_shading = false, .termination_threshold = 1e-4f};
  ParallelView view;
  double slab_mm = 1;
  int level = 0;  // of the fog

  FogView(double azimuth_deg, double elevation_deg, const AtlasContent& content,
          Quality quality = Quality::kNormal) {
    options.quality = quality;
    camera.azimuth_deg = azimuth_deg;
    camera.elevation_deg = elevation_deg;
    camera.zoom = zoom_for(content.display, 7, 0.83);
    camera.center_lps_mm = Vec3{0.5 * kWidth, 0.5 * kDepth, 0.5 * kWidth};
    view = *parallel_view(camera, options.size, content.display);
    slab_mm = factorise(view, storage_grid(content)).slab_mm;
  }
};

/// Full voxels of fog in front of `at`. In drafts fog fills slabs around the slices. Otherwise it rises
/// between the first two slices, falls behind the last, and each slab has its density halfway through. On
/// coarser levels fog fills slabs around blocks of slices, some of which may be empty.
double fog_until(double at, const FogView& view) {
  if (view.level > 0) {
    const double size = std::ldexp(1.0, view.level), blocks = std::ceil(kDepth / size);
    const double front = view.view.forward_lps[1] < 0 ? kDepth - blocks * size - 0.5 : -0.5;
    double voxels = 0;
    for (double begin = front; begin < front + blocks * size; begin += size) {
      const double full = std::min(begin + size, kDepth - 0.5) - std::max(begin, -0.5);
      voxels += full / size * std::clamp(at - begin, 0.0, size);
    }
    return voxels;
  }
  const int parts = reference::slabs_per_slice(view.options.quality);
  const double thickness = 1.0 / parts;
  const double first = parts == 1 ? -0.5 : -1;
  const int slabs = parts == 1 ? kDepth : (kDepth + 1) * parts;
  double voxels = 0;
  for (int n = 0; n < slabs; ++n) {
    const double begin = first + n * thickness;
    const double middle = begin + 0.5 * thickness;
    const double density = parts == 1 ? 1 : std::min({1.0, middle + 1, kDepth - middle});
    voxels += density * std::clamp(at - begin, 0.0, thickness);
  }
  return voxels;
}

/// Closed form: fog, and planes in this order.
std::array<double, 4> expected_pixel(const std::vector<Plane>& in_order, const FogView& view) {
  const double extinction = -std::log1p(-static_cast<double>(kFogOpacity));
  const auto fog_color = reference::linear_of(kFogColor);
  reference::RayRadiance sum;
  double from = -16;
  const auto add_fog = [&](double to) {
    const double voxels = fog_until(to, view) - fog_until(from, view);
    const double depth = extinction * view.slab_mm * voxels;
    const double opacity = -std::expm1(-depth);
    sum.add({{fog_color[0] * opacity, fog_color[1] * opacity, fog_color[2] * opacity}, 1 - opacity});
    from = to;
  };
  for (const Plane& plane : in_order) {
    add_fog(plane.at);
    const auto color = reference::shade_surface(view.view, reference::linear_of(plane.color),
                                                {0, view.view.forward_lps[1] < 0 ? 1.0 : -1.0, 0});
    const double opacity = plane.opacity;
    sum.add_surface({color[0] * opacity, color[1] * opacity, color[2] * opacity, opacity});
  }
  add_fog(2 * kDepth);
  return sum.rgba();
}

void expect_everywhere(const Picture& picture, const std::array<double, 4>& expected) {
  for (int n = 0; n < picture.size.width * picture.size.height; ++n) {
    const auto pixel = picture.at(n % picture.size.width, n / picture.size.width);
    for (std::size_t c = 0; c < 4; ++c) {
      // About ten float compositing steps, each rounding by some 1e-7.
      ASSERT_NEAR(pixel[c], expected[c], 1.5e-6) << "channel " << c << ", pixel " << n;
    }
  }
}

/// The closed form from all directions. `front_to_back`, `back_to_front`: the planes along y and against it.
void expect_closed_form(const std::vector<Plane>& planes, const std::vector<std::size_t>& front_to_back,
                        const std::vector<std::size_t>& back_to_front,
                        const std::vector<Quality>& qualities = {Quality::kNormal},
                        double draft_budget_ms = 0) {
  const AtlasContent content = fog_content(planes);
  Renderer renderer = renderer_of(content, fog_selection(planes));
  for (const auto& [azimuth, elevation] :
       {std::pair(0.0, 0.0), {180.0, 0.0}, {31.0, -17.0}, {-140.0, 25.0}, {44.9, 0.0}}) {
    for (const Quality quality : qualities) {
      SCOPED_TRACE(fmt::format("first plane at {}, azimuth {}", planes[0].at, azimuth));
      FogView view(azimuth, elevation, content, quality);
      view.options.draft_budget_ms = draft_budget_ms;
      if (draft_budget_ms > 0 &&
          draft_budget_ms < 1) {  // every draft is late, so that the next one is coarser
        ASSERT_TRUE(renderer.render(view.camera, view.options));
        view.level = renderer.render(view.camera, view.options)->stats.level;
        ASSERT_EQ(view.level, 2);
      }
      const bool behind = view.view.forward_lps[1] < 0;
      std::vector<Plane> in_order;
      for (const std::size_t n : behind ? back_to_front : front_to_back) {
        in_order.push_back(planes[n]);
        if (behind) in_order.back().at = kDepth - 1 - planes[n].at;  // the fog has the reverse order
      }
      expect_everywhere(render_or_throw(renderer, view.camera, view.options), expected_pixel(in_order, view));
    }
  }
}

/// Planes in front of the fog, on its border, on slices, halfway between, in between, and behind.
TEST(SurfaceInVolume, SweptPlanesFollowTheClosedForm) {
  for (int step = -16; step <= 16 * kDepth; ++step) {
    if (step % 4 != 0 && (step < 28 || step > 60)) continue;
    expect_closed_form({{step / 16.0, {255, 80, 20}, 0.6f, true}}, {0}, {0},
                       {Quality::kDraft, Quality::kNormal});
  }
}

/// Rays of drafts end at opaque surfaces.
TEST(SurfaceInVolume, RaysOfDraftsEndAtTheClosedForm) {
  for (int step = -16; step <= 16 * kDepth; ++step) {
    if (step % 4 != 0 && (step < 28 || step > 60)) continue;
    expect_closed_form({{step / 16.0, {255, 80, 20}, 1.0f, true}}, {0}, {0}, {Quality::kDraft}, 1e9);
  }
}

/// The same in perspective, where drafts without a budget have fragments.
TEST(SurfaceInVolume, RaysInPerspectiveEndAsFragmentsDo) {
  for (int step = -16; step <= 16 * kDepth; step += 6) {
    const std::vector<Plane> planes{{step / 16.0, {255, 80, 20}, 1.0f, true}};
    const AtlasContent content = fog_content(planes);
    Renderer renderer = renderer_of(content, fog_selection(planes));
    for (const double azimuth : {5.0, 175.0, -140.0}) {
      FogView view(azimuth, 20, content, Quality::kDraft);
      view.camera.projection = CameraProjection::kPerspective;
      const Picture fragments = render_or_throw(renderer, view.camera, view.options);
      view.options.draft_budget_ms = 1e9;
      const Frame ended = frame_or_throw(renderer, view.camera, view.options);
      EXPECT_TRUE(ended.stats.rays);
      for (std::size_t n = 0; n < fragments.rgba.size(); ++n)
        ASSERT_NEAR(ended.picture.rgba[n], fragments.rgba[n], 2e-6) << step << " " << azimuth;
    }
  }
}

/// Surfaces within means of voxels.
TEST(SurfaceInVolume, PlanesInCoarseDraftsFollowTheClosedForm) {
  for (int step = -16; step <= 16 * kDepth; step += 4) {
    for (const float opacity : {0.6f, 1.0f}) {
      expect_closed_form({{step / 16.0, {255, 80, 20}, opacity, true}}, {0}, {0}, {Quality::kDraft}, 1e-9);
    }
  }
}

/// A plane moves in steps of a tenth of a voxel. The picture changes monotonously towards the colour of the
/// fog, by at most the opacity of that tenth.
TEST(SurfaceInVolume, SweptPlanesChangeMonotonouslyAndContinuously) {
  double before = 2;
  for (int step = -8; step <= 10 * kDepth; ++step) {
    // Multiples of 1/4096, as in files.
    const std::vector<Plane> planes{{std::round(step / 10.0 * 4096) / 4096, {255, 255, 255}, 0.8f, true}};
    const AtlasContent content = fog_content(planes);
    const FogView view(23, -11, content);
    Selection selection = fog_selection(planes);
    selection.structures[0].color = {0, 0, 0};  // black fog before a white plane
    const double value = render_or_throw(content, selection, view.camera, view.options).at(3, 3)[1];
    const double max_change = -std::log1p(-static_cast<double>(kFogOpacity)) * view.slab_mm * 0.1001;
    EXPECT_LE(value, before + 1e-7) << "step " << step;
    if (before <= 1) {
      EXPECT_GE(value, before * (1 - max_change) - 1e-6) << "step " << step;
    }
    before = value;
  }
  EXPECT_LT(before, 0.4);
}

}  // namespace
}  // namespace splatlas
