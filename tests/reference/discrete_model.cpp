#include "tests/reference/discrete_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/reference/cubic.h"

namespace splatlas::reference {
namespace {

constexpr int kMaxSamplesPerSide = 16;

/// Radiance part of the way into a slab, as if its optical properties were constant.
RayRadiance part_of_slab(const RayRadiance& before, const RayRadiance& behind, double part) {
  if (!(behind.transmittance < before.transmittance)) return before;
  // Limits the logarithm of opaque slabs.
  constexpr double kMinTransmittance = 2e-4;
  const double transmittance =
      std::max(behind.transmittance, std::min(kMinTransmittance, before.transmittance));
  const double absorbed = 1 - transmittance / before.transmittance;
  const double share = absorbed > 0 ? -std::expm1(part * std::log1p(-absorbed)) / absorbed : part;
  RayRadiance sum = before;
  for (std::size_t c = 0; c < 3; ++c) sum.color[c] += share * (behind.color[c] - before.color[c]);
  sum.transmittance += share * (behind.transmittance - before.transmittance);
  return sum;
}

/// Length of a step of one pixel to the right, and one down, in the middle slice, in voxels.
std::array<double, 2> voxels_per_pixel(const ParallelView& view, const Grid& grid, Axis principal) {
  const ScanOrder axes = ScanOrder::of(principal);
  std::array<double, 2> reach{};
  const Ray origin = ray_through(view, grid, 0, 0);
  for (const std::size_t step : {0u, 1u}) {
    const Ray ray = ray_through(view, grid, step == 0 ? 1 : 0, step == 0 ? 0 : 1);
    Vec3 moved = minus(ray.start, origin.start);
    const double slices = moved[axes.slice_axis] / ray.per_mm[axes.slice_axis];
    for (std::size_t a = 0; a < 3; ++a) moved[a] -= slices * ray.per_mm[a];
    reach[step] = std::hypot(moved[axes.scan_axis], moved[axes.row_axis]);
  }
  return reach;
}

/// Width of a voxel in pixels.
double pixels_per_voxel(const ParallelView& view, const Grid& grid, Axis principal) {
  const std::array<double, 2> reach = voxels_per_pixel(view, grid, principal);
  return 1 / std::min(reach[0], reach[1]);
}

/// True for a dense selection.
bool is_sharp(const OpticalField& field) {
  return field.mean_densest * voxel_side_mm(field.grid) >= 1;
}

}  // namespace

int slabs_per_slice(Quality quality) {
  switch (quality) {
    case Quality::kNormal: return 4;
    case Quality::kHigh: return 8;
    case Quality::kDraft: break;
  }
  return 1;
}

int sheet_pixels_per_voxel(Quality quality, const ParallelView& view, const OpticalField& field,
                           Axis principal) {
  const double pixels = std::min(pixels_per_voxel(view, field.grid, principal), 1e3);
  const auto rounded = [&](double per_pixel, int min, int max) {
    return std::clamp(static_cast<int>(std::ceil(per_pixel * pixels - 0.25)), min, max);
  };
  const bool sharp = is_sharp(field);
  switch (quality) {
    case Quality::kNormal: return sharp ? rounded(2.25, 1, 6) : rounded(1.5, 1, 4);
    case Quality::kHigh: return rounded(sharp ? 2.5 : 2, 2, 8);
    case Quality::kDraft: break;
  }
  return rounded(1, 1, 2);
}

DiscreteModel::DiscreteModel(const OpticalField& field, const ParallelView& view, Axis principal,
                             int pixels_per_voxel, int parts, const ReferenceCut* cut)
    : field_(field),
      view_(view),
      cut_(cut),
      axes_(ScanOrder::of(principal)),
      pixels_per_voxel_(pixels_per_voxel),
      parts_(parts),
      slices_(field.grid.size[axes_.slice_axis]),
      middle_(0.5 * static_cast<double>(slices_ - 1)),
      per_mm_(ray_through(view, field.grid, 0, 0).per_mm) {}

DiscreteModel::Place DiscreteModel::place_of(double x, double y) const {
  const Ray ray = ray_through(view_, field_.grid, x, y);
  const Vec3 met = ray.at((middle_ - ray.start[axes_.slice_axis]) / ray.per_mm[axes_.slice_axis]);
  return {met[axes_.scan_axis], met[axes_.row_axis]};
}

double DiscreteModel::first_slab() const {
  const double nearest = per_mm_[axes_.slice_axis] > 0 ? 0.0 : 1.0 - static_cast<double>(slices_);
  return nearest - (parts_ == 1 ? 0.5 : 1.0);
}

Vec3 DiscreteModel::index_at(const Place& place, double k) const {
  const double along = per_mm_[axes_.slice_axis];
  Vec3 index{};
  index[axes_.slice_axis] = k;
  index[axes_.scan_axis] = place.u + (k - middle_) * per_mm_[axes_.scan_axis] / along;
  index[axes_.row_axis] = place.v + (k - middle_) * per_mm_[axes_.row_axis] / along;
  return index;
}

double DiscreteModel::kept_fraction(const Place& place, double k) const {
  if (cut_ == nullptr) return 1;
  double entering = 1, leaving = 1;
  for (const IndexPlane& plane : cut_->planes()) {
    // Differences of the distance across a slab, along the ray, and across a sheet pixel
    const double at = plane.distance(index_at(place, k));
    const double per_slice = plane.distance(index_at(place, k + 1)) - at;
    const double across_pixel =
        pixels_per_voxel_ == 0
            ? 0
            : (std::abs(plane.normal[axes_.scan_axis]) + std::abs(plane.normal[axes_.row_axis])) /
                  pixels_per_voxel_;
    const double width = std::max(std::abs(per_slice) / parts_, across_pixel - std::abs(per_slice));
    const double kept = std::clamp(0.5 - at / width, 0.0, 1.0);
    // Planes along the view count as leaving: rounding decides the sign
    const bool enters = (per_mm_[axes_.slice_axis] > 0 ? per_slice : -per_slice) < -1e-6;
    double& sum = enters ? entering : leaving;
    sum = std::min(sum, kept);
  }
  return std::max(0.0, entering + leaving - 1);
}

std::vector<RayRadiance> DiscreteModel::along_ray(const Place& place, std::span<const double> depths) const {
  const double along = per_mm_[axes_.slice_axis];
  const double thickness = 1.0 / parts_;
  const double voxel_mm = 1 / std::abs(along);
  std::vector<RayRadiance> before(depths.size() + 1);
  RayRadiance sum;
  for (std::int64_t n = 0; n < slabs(); ++n) {
    const double begin = first_slab() + static_cast<double>(n) * thickness;
    const double middle = begin + 0.5 * thickness;
    const double k = along > 0 ? middle : -middle;
    Vec3 index{};
    index[axes_.slice_axis] = parts_ == 1 ? std::round(k) : k;
    index[axes_.scan_axis] = place.u + (k - middle_) * per_mm_[axes_.scan_axis] / along;
    index[axes_.row_axis] = place.v + (k - middle_) * per_mm_[axes_.row_axis] / along;
    const VoxelOptics optics = field_.trilinear(index);
    const double kept_mm = voxel_mm * kept_fraction(place, k);
    for (std::size_t d = 0; d < depths.size(); ++d) {
      if (depths[d] < begin) continue;
      before[d] = sum;
      before[d].add(slab(optics, kept_mm * std::min(thickness, depths[d] - begin)));
    }
    sum.add(slab(optics, kept_mm * thickness));
  }
  before.back() = sum;
  return before;
}

std::vector<RayRadiance> DiscreteModel::warped(const Place& place, std::span<const double> depths) const {
  if (pixels_per_voxel_ == 0) return along_ray(place, depths);
  const double x = place.u * pixels_per_voxel_;
  const double y = place.v * pixels_per_voxel_;
  const double left = std::floor(x);
  const double upper = std::floor(y);
  std::vector<RayRadiance> sums(depths.size() + 1, RayRadiance{{0, 0, 0}, 0});
  const auto bilinear = [&](int dx, int dy) {
    return (dx == 1 ? x - left : 1 - (x - left)) * (dy == 1 ? y - upper : 1 - (y - upper));
  };
  const double skew = std::clamp(smear(), -std::min(bilinear(0, 0), bilinear(1, 1)),
                                 std::min(bilinear(0, 1), bilinear(1, 0)));
  for (const int dx : {0, 1}) {
    for (const int dy : {0, 1}) {
      const double weight = bilinear(dx, dy) + (dx == dy ? skew : -skew);
      const auto radiances =
          along_ray({(left + dx) / pixels_per_voxel_, (upper + dy) / pixels_per_voxel_}, depths);
      for (std::size_t n = 0; n < sums.size(); ++n) sums[n].add_weighted(weight, radiances[n]);
    }
  }
  return sums;
}

const RayRadiance& DiscreteModel::sheet_pixel(std::int64_t column, std::int64_t row) const {
  const auto [found, is_new] = sheet_.try_emplace({column, row});
  if (is_new) {
    const Place place{static_cast<double>(column) / pixels_per_voxel_,
                      static_cast<double>(row) / pixels_per_voxel_};
    found->second = along_ray(place, {}).back();
  }
  return found->second;
}

RayRadiance DiscreteModel::warped_cubic(const Place& place) const {
  const double x = place.u * pixels_per_voxel_;
  const double y = place.v * pixels_per_voxel_;
  RayRadiance sum{{0, 0, 0}, 0};
  for (int dx = -1; dx <= 2; ++dx) {
    for (int dy = -1; dy <= 2; ++dy) {
      const double column = std::floor(x) + dx, row = std::floor(y) + dy;
      const double weight = catmull_rom(x - column) * catmull_rom(y - row);
      sum.add_weighted(weight,
                       sheet_pixel(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row)));
    }
  }
  sum.transmittance = std::clamp(sum.transmittance, 0.0, 1.0);
  for (double& color : sum.color) color = std::clamp(color, 0.0, 1 - sum.transmittance);
  return sum;
}

double DiscreteModel::smear() const {
  const double along = per_mm_[axes_.slice_axis];
  const double slopes = per_mm_[axes_.scan_axis] / along * per_mm_[axes_.row_axis] / along;
  const double missing = parts_ == 1 ? 1.0 / 6 : -1.0 / (12 * parts_ * parts_);
  return std::clamp(slopes * missing * pixels_per_voxel_ * pixels_per_voxel_, -0.25, 0.25);
}

RayInterval DiscreteModel::kept_depths(double x, double y) const {
  if (cut_ == nullptr) return kWholeRay;
  const Ray ray = ray_through(view_, field_.grid, x, y);
  const KeptRay kept = cut_->clip(ray, -std::numeric_limits<double>::infinity());
  const double start = ray.start[axes_.slice_axis], along = ray.per_mm[axes_.slice_axis];
  const double sign = along > 0 ? 1 : -1;
  return {sign * start + std::abs(along) * kept.from_mm, sign * start + std::abs(along) * kept.to_mm};
}

std::vector<RayRadiance> DiscreteModel::at(double x, double y, std::span<const double> depths) const {
  const double thickness = 1.0 / parts_;
  std::vector<double> borders;  // borders of the slabs that contain the depths
  for (const double depth : depths) {
    const double slab =
        std::clamp(std::floor((depth - first_slab()) / thickness), 0.0, static_cast<double>(slabs() - 1));
    borders.push_back(first_slab() + slab * thickness);
    borders.push_back(first_slab() + (slab + 1) * thickness);
  }
  const std::vector<RayRadiance> radiances = warped(place_of(x, y), borders);
  const RayInterval kept = kept_depths(x, y);
  std::vector<RayRadiance> before;
  for (std::size_t n = 0; n < depths.size(); ++n) {
    const double from = std::max(borders[2 * n], kept.from_mm);
    const double to = std::min(borders[2 * n] + thickness, kept.to_mm);
    const double part = from < to ? std::clamp((depths[n] - from) / (to - from), 0.0, 1.0) : 0;
    before.push_back(part_of_slab(radiances[2 * n], radiances[2 * n + 1], part));
  }
  before.push_back(radiances.back());
  return before;
}

RayRadiance DiscreteModel::pixel_mean(int column, int row) const {
  const auto axis = static_cast<Axis>(axes_.slice_axis);
  const auto reach = voxels_per_pixel(view_, field_.grid, axis);
  const int samples =
      std::clamp(static_cast<int>(std::ceil(std::max(reach[0], reach[1]) - 0.25)), 1, kMaxSamplesPerSide);
  const bool cubic = parts_ > 1 && pixels_per_voxel_ > 0;
  RayRadiance sum{{0, 0, 0}, 0};
  for (int y = 0; y < samples; ++y) {
    for (int x = 0; x < samples; ++x) {
      const Place place = place_of(column + (x + 0.5) / samples, row + (y + 0.5) / samples);
      sum.add_weighted(1.0 / (samples * samples), cubic ? warped_cubic(place) : warped(place, {}).back());
    }
  }
  return sum;
}

}  // namespace splatlas::reference
