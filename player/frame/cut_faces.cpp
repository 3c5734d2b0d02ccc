#include "player/frame/cut_faces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "format/system/result_macros.h"
#include "format/system/task_control.h"

namespace splatlas {
namespace {

constexpr std::size_t kRowsPerJob = 8;

/// Linear light of sRGB intensities from 0 to 1 (IEC 61966-2-1), interpolated to 3e-8.
class LinearLight {
 public:
  LinearLight() {
    for (std::size_t n = 0; n < table_.size(); ++n) {
      const double encoded = static_cast<double>(n) / kSteps;
      table_[n] =
          static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
    }
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

const LinearLight& linear_light() {
  static const LinearLight kLight;
  return kLight;
}

}  // namespace

Result<CutFaces> CutFaces::build(const CutPlanes& planes, std::vector<FaceClass> classes, FaceVoxels voxels,
                                 const CutFaces* former, ThreadPool& pool) {
  CutFaces faces;
  faces.planes_ = planes;
  faces.classes_ = std::move(classes);
  voxels.classes = faces.classes_;
  const std::vector<VoxelPlane> of_grid = voxel_planes(planes, voxels.atlas.grid());
  for (std::size_t n = 0; n < planes.size(); ++n) {
    if (former != nullptr) {
      const CutPlane* known = std::find(former->planes_.begin(), former->planes_.end(), planes.begin()[n]);
      const auto place = static_cast<std::size_t>(known - former->planes_.begin());
      if (place < former->maps_.size()) {
        faces.maps_.push_back(former->maps_[place]);
        continue;
      }
    }
    SPLATLAS_ASSIGN_OR_RETURN(FaceMap map, FaceMap::build(of_grid[n], voxels, pool));
    faces.maps_.push_back(std::make_shared<const FaceMap>(std::move(map)));
  }
  return faces;
}

Face CutFaces::at(int plane, const Vec3& index, CapMode mode) const {
  const FaceMap& map = *maps_[static_cast<std::size_t>(plane)];
  const FaceSample sample = map.at(index[map.axis_b()], index[map.axis_c()]);
  const FaceClass& of_class = classes_[sample.id];
  if (sample.id == kEmptyClass || !of_class.has_face()) return {};
  Face face;
  face.structure = of_class.structure;
  const float grey = mode == CapMode::kLabels ? 1 : linear_light().of(sample.grey);
  for (std::size_t c = 0; c < 3; ++c) {
    const float color = mode == CapMode::kValues ? 1 : of_class.color[c];
    face.rgba[c] = of_class.opacity * grey * color;
  }
  face.rgba[3] = of_class.opacity;
  return face;
}

RayFaces ViewFaces::through(double x, double y) const {
  RayFaces faces;
  const KeptInterval kept = rays_.through(x, y);
  if (kept.empty()) return faces;
  const auto face_at = [&](int plane, double t) {
    const Vec3 index = rays_.index_at(x, y, t);
    Face face = faces_.at(plane, index, mode_);
    face.depth = static_cast<float>(sign_ * index[axis_]);
    return face;
  };
  if (kept.front != KeptInterval::kNoPlane) faces.front = face_at(kept.front, kept.from);
  if (kept.back != KeptInterval::kNoPlane) faces.back = face_at(kept.back, kept.to);
  return faces;
}

void fill_faces(const ViewFaces& faces, const PictureSize& size, FaceLayer& layer, ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(size.width), height = static_cast<std::size_t>(size.height);
  layer.front.resize(width * height);
  layer.back.resize(width * height);
  pool.for_each((height + kRowsPerJob - 1) / kRowsPerJob, [&](std::size_t job) {
    check_cancelled();
    for (std::size_t row = job * kRowsPerJob; row < std::min(height, (job + 1) * kRowsPerJob); ++row) {
      const double y = static_cast<double>(row) + 0.5;
      for (std::size_t column = 0; column < width; ++column) {
        const RayFaces of_ray = faces.through(static_cast<double>(column) + 0.5, y);
        layer.front[row * width + column] = of_ray.front;
        layer.back[row * width + column] = of_ray.back;
      }
    }
  });
}

}  // namespace splatlas
