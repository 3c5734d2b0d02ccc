#include "player/class_cache.h"

#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <sys/mman.h>

namespace splatlas {

std::vector<ClassId> volume_classes(const DrawPlan& plan) {
  std::vector<ClassId> classes;
  for (const ClassDraw& draw : plan.classes) {
    if (draws_volume(draw.role)) classes.push_back(draw.id);
  }
  return classes;
}

SparseBytes::SparseBytes(SparseBytes&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

SparseBytes& SparseBytes::operator=(SparseBytes&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

SparseBytes::~SparseBytes() {
  if (data_ != nullptr) munmap(data_, size_);
}

Result<SparseBytes> SparseBytes::reserve(std::size_t bytes) {
  void* data =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (data == MAP_FAILED) {
    return fail(ErrorCode::kLimit,
                fmt::format("cannot reserve {} bytes of address space for grey values", bytes));
  }
  SparseBytes sparse;
  sparse.data_ = static_cast<std::byte*>(data);
  sparse.size_ = bytes;
  return sparse;
}

Result<void> ClassCache::require(std::span<const ClassId> classes, Axis axis, ThreadPool& pool) {
  const std::size_t value_bytes = bytes_of(atlas_->value_type());
  const auto voxels = static_cast<std::size_t>(atlas_->grid().voxels());
  if (value_bytes > 0 && values_.data() == nullptr && !classes.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(values_, SparseBytes::reserve(voxels * value_bytes));
  }
  if (normals_.data() == nullptr && !classes.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(normals_, SparseBytes::reserve(voxels * sizeof(PackedNormal)));
  }
  struct Missing {
    ClassId id = kEmptyClass;
    DecodedClass* decoded = nullptr;
    NewRuns runs;
    Result<void> result;
  };
  std::vector<Missing> missing;
  for (const ClassId c : classes) {
    DecodedClass& decoded = classes_[c];
    if (!decoded.has_voxels || !decoded.run_count[static_cast<std::size_t>(axis)])
      missing.push_back({c, &decoded, {}, {}});
  }
  if (missing.empty()) return {};
  pool.for_each(missing.size(), [&](std::size_t n) {
    Missing& of = missing[n];
    of.result = decode(of.id, axis, *of.decoded, of.runs);
  });
  Result<void> first_failure;
  for (const Missing& of : missing) {
    if (of.result) continue;
    if (first_failure) first_failure = of.result;
    if (!of.decoded->has_voxels) classes_.erase(of.id);
  }
  for (const Axis read : kAxes) {
    const auto n = static_cast<std::size_t>(read);
    std::vector<std::pair<ClassId, const ClassRuns*>> runs;
    for (const Missing& of : missing) {
      if (of.result && of.runs[n]) runs.emplace_back(of.id, &*of.runs[n]);
    }
    keep_runs(read, runs, pool);
  }
  return first_failure;
}

void ClassCache::keep_runs(Axis axis, std::span<const std::pair<ClassId, const ClassRuns*>> runs,
                           ThreadPool& pool) {
  const auto n = static_cast<std::size_t>(axis);
  try {
    runs_[n].insert(runs, atlas_->grid().size[ScanOrder::of(axis).row_axis], pool);
  } catch (...) {  // out of memory: some are there, some are not
    runs_[n] = {};
    for (auto& [id, decoded] : classes_) decoded.run_count[n].reset();
    throw;
  }
  for (const auto& [id, of_class] : runs) classes_[id].run_count[n] = of_class->size();
}

Result<void> ClassCache::decode(ClassId c, Axis axis, DecodedClass& decoded, NewRuns& read) {
  const auto read_runs = [&](Axis wanted) -> Result<void> {
    const auto n = static_cast<std::size_t>(wanted);
    if (decoded.run_count[n] || read[n]) return {};
    SPLATLAS_ASSIGN_OR_RETURN(read[n], atlas_->read_runs(c, wanted));
    return {};
  };
  SPLATLAS_RETURN_IF_ERROR(read_runs(axis));
  if (decoded.has_voxels) return {};
  // Values and normals are stored in memory order, which is the order of the z model.
  SPLATLAS_RETURN_IF_ERROR(read_runs(Axis::kZ));
  SPLATLAS_RETURN_IF_ERROR(place_voxels(c, *read[static_cast<std::size_t>(Axis::kZ)]));
  decoded.has_voxels = true;
  return {};
}

Result<void> ClassCache::place_voxels(ClassId c, const ClassRuns& z_runs) {
  const auto row_voxels = static_cast<std::uint64_t>(atlas_->grid().size[0]);
  const auto scatter = [&](const void* from, std::size_t voxel_bytes, std::byte* to) {
    const auto* next = static_cast<const std::byte*>(from);
    for (const Run& run : z_runs) {
      const std::size_t bytes = run.length * voxel_bytes;
      std::memcpy(to + (run.scanline * row_voxels + run.start) * voxel_bytes, next, bytes);
      next += bytes;
    }
  };
  if (atlas_->value_type() != VoxelType::kNone) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> values, atlas_->read_values(c));
    scatter(values.data(), bytes_of(atlas_->value_type()), values_.data());
  }
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<PackedNormal> normals, atlas_->read_normals(c));
  if (!normals.empty()) scatter(normals.data(), sizeof(PackedNormal), normals_.data());
  return {};
}

Result<void> ClassCache::require_surfaces(std::span<const StructureIndex> structures, ThreadPool& pool) {
  std::vector<StructureIndex> missing;
  for (const StructureIndex s : structures) {
    if (!surfaces_.contains(s)) missing.push_back(s);
  }
  std::vector<Result<SurfaceMesh>> meshes(missing.size());
  pool.for_each(missing.size(), [&](std::size_t n) { meshes[n] = atlas_->read_surface(missing[n]); });
  for (std::size_t n = 0; n < missing.size(); ++n) {
    if (!meshes[n]) return tl::unexpected<Error>(std::move(meshes[n]).error());
    surfaces_.emplace(missing[n], std::move(*meshes[n]));
  }
  return {};
}

std::size_t ClassCache::run_count(ClassId c, Axis axis) const {
  return *classes_.at(c).run_count[static_cast<std::size_t>(axis)];
}

const SurfaceMesh& ClassCache::surface(StructureIndex s) const {
  return surfaces_.at(s);
}

}  // namespace splatlas
