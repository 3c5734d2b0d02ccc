#include "player/render/decode/class_cache.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>

#include "format/derive/value_groups.h"
#include "format/file/directory.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

std::vector<ClassId> volume_classes(const DrawPlan& plan) {
  std::vector<ClassId> classes;
  for (const ClassDraw& draw : plan.classes) {
    if (draws_volume(draw.role)) classes.push_back(draw.id);
  }
  return classes;
}

/// Missing parts of a required class, and the result of reading them.
struct ClassCache::Missing {
  ClassId id = kEmptyClass;
  std::array<bool, 3> runs{};  // [axis]
  bool values = false, normals = false;
  std::array<ClassRuns, 3> read{};
  Result<void> result{};
};

namespace {

/// Removes the classes of failed groups from a plan and its voxel counts, and adds them to `missing`.
void leave_out_groups(const std::map<std::uint32_t, Error>& failed, const ValueGroups& groups,
                      const ClassTable& classes, DrawPlan& plan,
                      std::map<StructureIndex, MissingPart>& missing) {
  std::erase_if(plan.classes, [&](const ClassDraw& draw) {
    const auto found = failed.find(groups.group_of[draw.id]);
    if (found == failed.end() || !draws_volume(draw.role)) return false;
    const std::uint64_t voxels = classes.voxels(draw.id);
    (draw.role == VoxelRole::kHybrid ? plan.hybrid_voxels : plan.volume_voxels) -= voxels;
    const auto [part, is_new] = missing.try_emplace(draw.volume_of);
    if (is_new) part->second = {draw.volume_of, false, 0, found->second};
    part->second.voxels += voxels;
    return true;
  });
}

}  // namespace

std::vector<ClassCache::Missing> ClassCache::missing_of(std::span<const ClassId> classes, Axis axis,
                                                        VoxelParts parts) const {
  const bool values = parts >= VoxelParts::kValues && atlas_->value_type() != VoxelType::kNone;
  const bool normals = parts == VoxelParts::kNormals;
  std::vector<Missing> missing;
  for (const ClassId c : classes) {
    const auto known = classes_.find(c);
    const DecodedClass decoded = known == classes_.end() ? DecodedClass{} : known->second;
    Missing lacks{
        .id = c, .values = !decoded.has_values && values, .normals = !decoded.has_normals && normals};
    for (const Axis each : kAxes) {
      const auto n = static_cast<std::size_t>(each);
      lacks.runs[n] = !decoded.run_count[n] && (each == axis || (each == Axis::kZ && normals && values));
    }
    if (lacks.runs != std::array<bool, 3>{} || lacks.values || lacks.normals)
      missing.push_back(std::move(lacks));
  }
  return missing;
}

double ClassCache::memory_of(std::span<const Missing> missing, Axis axis, VoxelParts parts) const {
  const Grid& grid = atlas_->grid();
  const auto voxel_bytes = static_cast<double>((parts >= VoxelParts::kValues ? value_bytes() : 0) +
                                               (parts == VoxelParts::kNormals ? sizeof(VoxelLight) : 0));
  const double grid_bytes = static_cast<double>(grid.voxels()) * voxel_bytes;
  constexpr double kPageBytes = 4096;
  double voxels = 0, pages = 0;
  for (const Missing& of : missing) {
    const IndexBox& of_class = atlas_->classes().box(of.id);
    const auto of_slices = static_cast<double>(of_class.last[2] - of_class.first[2] + 1);
    const auto in_class = static_cast<double>(atlas_->classes().voxels(of.id));
    voxels += in_class;
    pages +=
        std::min(2 * in_class, 2 + of_slices / static_cast<double>(grid.size[2]) * grid_bytes / kPageBytes);
  }
  // Values and light are spread over the pages of the grid
  pages = std::min(pages, 2 + grid_bytes / kPageBytes);
  constexpr double kRunBytes = 3 * sizeof(ClassRun);
  const std::uint64_t runs = std::max(atlas_->runs(axis), atlas_->runs(Axis::kZ));
  return pages * kPageBytes + kRunBytes * std::min(voxels, static_cast<double>(runs));
}

std::uint64_t ClassCache::bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& [id, decoded] : classes_) {
    const std::uint64_t of_voxel =
        (decoded.has_values ? value_bytes() : 0) + (decoded.has_normals ? sizeof(VoxelLight) : 0);
    bytes += of_voxel * atlas_->classes().voxels(id);
    for (const auto& runs : decoded.run_count) bytes += runs.value_or(0) * sizeof(ClassRun);
  }
  for (const auto& [key, surface] : surfaces_) bytes += surface.bytes();
  return bytes;
}

void ClassCache::begin(std::span<const StructureIndex> drawn, std::uint64_t bytes) {
  ++selection_;
  std::vector<std::pair<std::uint64_t, SurfaceKey>> spare;  // by the latest use
  for (auto& [key, surface] : surfaces_) {
    if (std::binary_search(drawn.begin(), drawn.end(), key.second)) surface.used = selection_;
    if (surface.used < selection_) spare.emplace_back(surface.used, key);
  }
  std::ranges::sort(spare, std::greater{});
  for (std::uint64_t sum = 0; const auto& [used, key] : spare) {
    sum += surfaces_.at(key).bytes();
    if (sum > bytes) surfaces_.erase(key);
  }
}

Result<void> ClassCache::reserve(std::span<const Missing> missing) {
  const auto voxels = static_cast<std::uint64_t>(atlas_->grid().voxels());
  constexpr std::uint64_t kMaxDense = std::uint64_t{32} << 20;  // larger volumes are mostly air
  const auto reserve_part = [&](SparseBytes& bytes, std::uint64_t per_voxel, auto part) -> Result<void> {
    if (bytes.data() != nullptr || !std::ranges::any_of(missing, part)) return {};
    SPLATLAS_ASSIGN_OR_RETURN(bytes, SparseBytes::reserve(voxels * per_voxel));
    if (bytes.size() <= kMaxDense) bytes.expect_dense();
    return {};
  };
  SPLATLAS_RETURN_IF_ERROR(reserve_part(values_, value_bytes(), &Missing::values));
  return reserve_part(lights_, sizeof(VoxelLight), &Missing::normals);
}

Result<void> ClassCache::require(std::span<const ClassId> classes, Axis axis, ThreadPool& pool,
                                 VoxelParts parts) {
  failed_classes_.clear();
  std::vector<Missing> missing = missing_of(classes, axis, parts);
  if (missing.empty()) return {};
  check_memory(memory_of(missing, axis, parts));
  SPLATLAS_RETURN_IF_ERROR(reserve(missing));

  // Sort the largest classes first for load balance. Small classes share chunks and stay in order. Boundary
  // classes come last: a structure's two classes are decoded together, so that concurrent threads would wait.
  constexpr std::uint64_t kSmall = 16384;
  std::ranges::stable_sort(missing, std::greater{}, [&](const Missing& of) {
    return std::pair(!has_normals(atlas_->classes(), of.id),
                     std::max(kSmall, atlas_->classes().voxels(of.id)));
  });

  // Decode in parallel and record the results
  pool.for_each(missing.size(), [&](std::size_t n) { missing[n].result = decode(missing[n]); });
  for (const Axis each : kAxes) {
    std::vector<std::pair<ClassId, const ClassRuns*>> runs;
    for (const Missing& of : missing) {
      const auto n = static_cast<std::size_t>(each);
      if (of.result && of.runs[n]) runs.emplace_back(of.id, &of.read[n]);
    }
    keep_runs(runs, each, atlas_->grid().size[ScanOrder::of(each).row_axis], pool);
  }
  if (parts >= VoxelParts::kValues) atlas_->forget_runs();
  for (const Missing& of : missing) {
    if (!of.result) {
      failed_classes_.push_back({of.id, of.result.error()});
      continue;
    }
    DecodedClass& decoded = classes_[of.id];
    decoded.has_values = decoded.has_values || of.values;
    decoded.has_normals = decoded.has_normals || of.normals;
    if (of.normals) decoded.light = {};
  }
  if (failed_classes_.empty()) return {};
  return tl::unexpected(failed_classes_.front().error);
}

void ClassCache::keep_runs(std::span<const std::pair<ClassId, const ClassRuns*>> runs, Axis axis,
                           std::int64_t rows, ThreadPool& pool) {
  const auto n = static_cast<std::size_t>(axis);
  if (runs.empty()) return;
  try {
    runs_[n].insert(runs, rows, pool);
    for (const auto& [id, of_class] : runs) classes_[id].run_count[n] = of_class->size();
  } catch (...) {  // out of memory: discard the partial insertion
    runs_[n] = {};
    for (auto& [id, decoded] : classes_) decoded.run_count[n].reset();
    throw;
  }
}

/// Values and normals are stored in memory order; the runs along z give their voxels.
Result<void> ClassCache::decode(Missing& missing) const {
  for (const Axis axis : kAxes) {
    const bool scatters = axis == Axis::kZ && (missing.values || missing.normals);
    const auto n = static_cast<std::size_t>(axis);
    if (!missing.runs[n] && !scatters) continue;
    SPLATLAS_ASSIGN_OR_RETURN(missing.read[n], atlas_->read_runs(missing.id, axis));
  }
  // Calls take(first voxel of a run, number of its first value, voxels)
  const auto for_each_run = [&](const auto& take) {
    const auto row_voxels = static_cast<std::uint64_t>(atlas_->grid().size[0]);
    std::size_t n = 0;
    TaskPace pace;
    for (const Run& run : missing.read[static_cast<std::size_t>(Axis::kZ)]) {
      pace.step();
      take(run.scanline * row_voxels + run.start, n, run.length);
      n += run.length;
    }
  };
  if (missing.values) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> values, atlas_->read_values(missing.id));
    const std::size_t bytes = value_bytes();
    for_each_run([&](std::uint64_t voxel, std::size_t n, std::uint32_t count) {
      std::memcpy(values_.data() + voxel * bytes, values.data() + n * bytes, count * bytes);
    });
  }
  check_task();
  if (missing.normals) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<PackedNormal> normals, atlas_->read_normals(missing.id));
    auto* const lights = reinterpret_cast<VoxelLight*>(lights_.data());
    if (normals.empty()) return {};
    for_each_run([&](std::uint64_t voxel, std::size_t n, std::uint32_t count) {
      for (std::uint32_t k = 0; k < count; ++k) lights[voxel + k] = {normals[n + k], VoxelLight::kAllLit};
    });
  }
  return {};
}

void ClassCache::forget_lost_normals(ClassId c, StructureIndex structure) {
  const auto known = classes_.find(c);
  if (known == classes_.end()) return;
  const LightState& light = known->second.light;
  if (light != LightState{} && light != LightState{LightState::Of::kBorder, structure})
    known->second.has_normals = false;
}

Result<ClassCache::SharedSurface> ClassCache::decode_surface(StructureIndex s, int level) const {
  // Caches own their atlas: its address is that of another one only once all of its surfaces are gone
  static std::mutex mutex;
  static std::map<std::tuple<const Atlas*, StructureIndex, std::size_t>, std::weak_ptr<const DecodedSurface>>
      known;
  const std::tuple key(atlas_.get(), s, kept_level(s, level));
  {
    const std::lock_guard lock(mutex);
    if (SharedSurface found = known[key].lock()) return found;
  }
  SPLATLAS_ASSIGN_OR_RETURN(SurfaceMesh mesh, atlas_->read_surface(s, level));
  SurfaceClusters clusters(mesh, atlas_->grid());
  const auto decoded =
      std::make_shared<const DecodedSurface>(DecodedSurface{std::move(mesh), std::move(clusters)});
  const std::lock_guard lock(mutex);
  if (SharedSurface quicker = known[key].lock()) return quicker;
  std::erase_if(known, [](const auto& each) { return each.second.expired(); });
  known[key] = decoded;
  return decoded;
}

Result<void> ClassCache::require_surfaces(std::span<const StructureIndex> structures, ThreadPool& pool,
                                          int level) {
  failed_surfaces_.clear();
  std::vector<StructureIndex> missing;
  for (const StructureIndex s : structures) {
    if (!has_surface(s, level)) missing.push_back(s);
  }
  // Large ones first, for load balance
  std::ranges::stable_sort(missing, std::greater{}, [&](StructureIndex s) { return atlas_->triangles(s); });
  std::vector<Result<SharedSurface>> surfaces(missing.size());
  pool.for_each(missing.size(), [&](std::size_t n) { surfaces[n] = decode_surface(missing[n], level); });
  for (std::size_t n = 0; n < missing.size(); ++n) {
    if (surfaces[n]) {
      surfaces_[{kept_level(missing[n], level), missing[n]}] = {std::move(*surfaces[n]), selection_};
    } else {
      failed_surfaces_.push_back({missing[n], std::move(surfaces[n]).error()});
    }
  }
  if (failed_surfaces_.empty()) return {};
  return tl::unexpected(failed_surfaces_.front().error);
}

std::vector<MissingPart> leave_out(std::span<const FailedClass> failed_classes,
                                   std::span<const FailedSurface> failed_surfaces, const ClassTable& classes,
                                   DrawPlan& plan) {
  std::map<StructureIndex, MissingPart> volumes;
  if (!failed_classes.empty()) {
    const ValueGroups groups(classes);
    std::map<std::uint32_t, Error> failed;
    for (const FailedClass& of : failed_classes) failed.try_emplace(groups.group_of[of.id], of.error);
    leave_out_groups(failed, groups, classes, plan, volumes);
  }
  std::vector<MissingPart> missing;
  for (auto& [structure, part] : volumes) missing.push_back(std::move(part));
  for (const FailedSurface& of : failed_surfaces) {
    std::erase(plan.surfaces, of.structure);
    missing.push_back({of.structure, true, 0, of.error});
  }
  return missing;
}

}  // namespace splatlas
