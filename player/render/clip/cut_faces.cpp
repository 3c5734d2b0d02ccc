#include "player/render/clip/cut_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <utility>

#include "format/content/color.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

constexpr std::size_t kRowsPerJob = 8;

/// Linear light of sRGB intensities from 0 to 1 (IEC 61966-2-1), interpolated to 3e-8.
class LinearLight {
 public:
  LinearLight() {
    for (std::size_t n = 0; n < table_.size(); ++n)
      table_[n] = static_cast<float>(decode_srgb(static_cast<double>(n) / kSteps));
  }
  [[nodiscard]] float of(float encoded) const {
    const float place = std::clamp(encoded, 0.0f, 1.0f) * kSteps;
    const auto n = std::min(static_cast<std::size_t>(place), std::size_t{kSteps} - 1);
    return table_[n] + (place - static_cast<float>(n)) * (table_[n + 1] - table_[n]);
  }

 private:
  static constexpr int kSteps = 4096;
  std::array<float, kSteps + 1> table_{};
};

/// Paints the faces of a style: its colour, darkened or whitened to the grey value's luminance (Rec. 709).
struct FacePaint {
  const FaceStyle* style;
  bool is_flat;
  std::array<float, 3> color{};
  float luminance, per_dark, per_light;

  FacePaint(const FaceStyle& of, CapMode mode, bool has_greys)
      : style(&of), is_flat(mode == CapMode::kLabels || (mode == CapMode::kBoth && !has_greys)) {
    constexpr float kTiny = std::numeric_limits<float>::min();
    if (mode != CapMode::kValues) color = of.color;
    luminance = 0.2126f * color[0] + 0.7152f * color[1] + 0.0722f * color[2];
    per_dark = 1 / std::max(luminance, kTiny);
    per_light = 1 / std::max(1 - luminance, kTiny);
  }
  [[nodiscard]] Face face(float grey, float depth) const {
    static const LinearLight kLinear;
    const float light = kLinear.of(grey);
    const float share = is_flat ? 1 : std::min(light * per_dark, (1 - light) * per_light);
    const float white = is_flat ? 0 : light - std::min(share * luminance, light);
    const auto shown = [&](float c) { return style->opacity * (share * c + white); };
    return {{shown(color[0]), shown(color[1]), shown(color[2]), style->opacity}, depth, style->structure};
  }
};

}  // namespace

Result<CutFaces> CutFaces::build(const CutPlanes& planes, const FaceScene& scene, const CutFaces* former,
                                 ThreadPool& pool) {
  CutFaces faces;
  faces.planes_ = planes;
  const std::vector<VoxelPlane> of_grid = voxel_planes(planes, scene.atlas.grid());
  for (std::size_t n = 0; n < planes.size(); ++n) {
    if (former != nullptr) {
      const CutPlane* known = std::find(former->planes_.begin(), former->planes_.end(), planes.begin()[n]);
      const auto place = static_cast<std::size_t>(known - former->planes_.begin());
      if (place < former->maps_.size()) {
        faces.maps_.push_back(former->maps_[place]);
        continue;
      }
    }
    SPLATLAS_ASSIGN_OR_RETURN(FaceMap map, FaceMap::build(of_grid[n], scene, pool));
    faces.maps_.push_back(std::make_shared<const FaceMap>(std::move(map)));
  }
  return faces;
}

RayFaces ViewFaces::through(double x, double y) const {
  RayFaces faces;
  const ClipInterval kept = rays_.through(x, y);
  if (kept.empty()) return faces;
  const auto set = [&](int plane, double t, Face& out) {
    const Vec3 index = rays_.index_at(x, y, t);
    const FaceMap& map = faces_.map(plane);
    map.along(index[map.axis_b()], index[map.axis_c()], 0, 0, 1, [&](std::int64_t, const FaceSample& sample) {
      const FacePaint paint(*sample.style, mode_, map.has_greys());
      out = paint.face(sample.grey, static_cast<float>(sign_ * index[axis_]));
    });
  };
  if (kept.front != ClipInterval::kNoPlane) set(kept.front, kept.from, faces.front);
  if (kept.back != ClipInterval::kNoPlane) set(kept.back, kept.to, faces.back);
  return faces;
}

FaceLayer::Extent ViewFaces::row(std::int32_t row, std::int32_t width, Face* front, Face* back) const {
  const double y = row + 0.5;
  if (rays_.is_parallel()) return row_of_parallel_rays(y, width, front, back);
  FaceLayer::Extent shown{width, 0};
  for (std::int32_t column = 0; column < width; ++column) {
    const RayFaces faces = through(column + 0.5, y);
    if (!faces.show()) continue;
    front[column] = faces.front;
    back[column] = faces.back;
    shown = {std::min(shown.first, column), column + 1};
  }
  return shown;
}

FaceLayer::Extent ViewFaces::row_of_parallel_rays(double y, std::int32_t width, Face* front,
                                                  Face* back) const {
  const CutRays::Row row = rays_.row(y, width);
  FaceLayer::Extent shown{width, 0};
  for (const CutRays::RowCrossing& of : row.crossings) {
    // Find the pixels whose kept part begins, or ends, at this plane
    double first = row.first, last = row.last;
    for (const CutRays::RowCrossing& other : row.crossings) {
      if (&other == &of) continue;
      const double sign = other.enters ? 1 : -1;  // this plane must be behind those that rays enter
      const double at_zero = sign * (of.at_zero - other.at_zero), per_x = sign * (of.per_x - other.per_x);
      if (per_x == 0) {
        const bool wins =
            at_zero > 0 || (at_zero == 0 && of.enters == other.enters && of.plane < other.plane);
        if (!wins) last = -1;
      } else {
        const double at = -at_zero / per_x;
        (per_x > 0 ? first : last) = per_x > 0 ? std::max(first, at) : std::min(last, at);
      }
    }
    const auto pixel = [&](double x) {  // planes nearly parallel to each other meet far outside the picture
      return static_cast<std::int32_t>(std::ceil(std::clamp(x, 0.0, static_cast<double>(width)) - 0.5));
    };
    const std::int32_t begin = pixel(first), end = pixel(last);
    if (begin >= end) continue;

    const FaceMap& map = faces_.map(of.plane);
    const double x = begin + 0.5;
    const Vec3 here = rays_.index_at(x, y, of.at_zero + of.per_x * x);
    const Vec3 next = rays_.index_at(x + 1, y, of.at_zero + of.per_x * (x + 1));
    const auto step = [&](std::size_t axis) { return next[axis] - here[axis]; };
    Face* const out = (of.enters ? front : back) + begin;
    std::optional<FacePaint> paint;
    map.along(here[map.axis_b()], here[map.axis_c()], step(map.axis_b()), step(map.axis_c()), end - begin,
              [&](std::int64_t n, const FaceSample& sample) {
                const double along = here[axis_] + static_cast<double>(n) * step(axis_);
                if (!paint || paint->style != sample.style)
                  paint.emplace(*sample.style, mode_, map.has_greys());
                out[n] = paint->face(sample.grey, static_cast<float>(sign_ * along));
                const auto column = static_cast<std::int32_t>(begin + n);
                shown = {std::min(shown.first, column), std::max(shown.last, column + 1)};
              });
  }
  return shown;
}

void fill_faces(const ViewFaces& faces, const PictureSize& size, const PixelBox& region, FaceLayer& layer,
                ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(size.width), height = static_cast<std::size_t>(size.height);
  const bool has_back = faces.has_back();
  const auto no_faces = [&] {
    Result<SparseBytes> zeros = SparseBytes::reserve(width * height * sizeof(Face));
    return zeros ? *std::move(zeros) : throw std::bad_alloc();
  };
  if (layer.size != size || layer.empty() || (layer.back() == nullptr) == has_back) {
    layer.size = size;
    layer.of_front = no_faces();
    layer.of_back = has_back ? no_faces() : SparseBytes();
    layer.shown.assign(height, {});
  }
  const auto first = static_cast<std::size_t>(region.y_first),
             end = static_cast<std::size_t>(region.y_last) + 1;
  pool.for_each((end - first + kRowsPerJob - 1) / kRowsPerJob, [&](std::size_t job) {
    check_task();
    for (std::size_t row = first + job * kRowsPerJob; row < std::min(end, first + (job + 1) * kRowsPerJob);
         ++row) {
      Face* const front = layer.front() + row * width;
      Face* const back = has_back ? layer.back() + row * width : nullptr;
      FaceLayer::Extent& shown = layer.shown[row];
      std::fill(front + shown.first, front + std::max(shown.first, shown.last), Face{});
      if (has_back) std::fill(back + shown.first, back + std::max(shown.first, shown.last), Face{});
      shown = {0, size.width};  // in case of an exception
      shown = faces.row(static_cast<std::int32_t>(row), size.width, front, back);
      if (shown.first >= shown.last) shown = {};
    }
  });
}

void add_faces(const FaceLayer& layer, Picture& picture, ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(picture.size.width);
  const auto height = static_cast<std::size_t>(picture.size.height);
  pool.for_each((height + kRowsPerJob - 1) / kRowsPerJob, [&](std::size_t job) {
    for (std::size_t row = job * kRowsPerJob; row < std::min(height, (job + 1) * kRowsPerJob); ++row)
      layer.add_to_row(row, 0, picture.size.width, &picture.rgba[4 * row * width]);
  });
}

}  // namespace splatlas
