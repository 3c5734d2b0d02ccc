// Estimates of the work of reading parts of an atlas, from its directory alone. Weights are upper bounds of
// nanoseconds per item, measured on one core (docs/reliability.md, Work budget).
#include <algorithm>
#include <limits>
#include <numeric>

#include "format/codec/mask_codec.h"
#include "format/codec/value_codec.h"
#include "format/derive/fit_surface.h"
#include "format/file/atlas_impl.h"
#include "format/file/fitted_content.h"

namespace splatlas {
namespace {

constexpr double kPerDecodedByte = 4;
constexpr double kPerRun = 60;
constexpr double kPerSortedRun = 60;  // of all classes together
constexpr double kBytesPerReadRun = 3 * sizeof(Run), kBytesPerVerifiedRun = 24;
/// Of PartRows after sort(), and of the four rows of cells around each row.
constexpr double kBytesPerSortedRun = 48 + 64;
constexpr double kPerMaskVoxel = 6;     // of the box
constexpr double kPerDerivedVoxel = 8;  // of a run model that is not stored
constexpr double kPerPredictedByte = 30;
constexpr double kPerValueByte = 8;
constexpr double kPerCropVoxel = 2.5, kPerFittedVertex = 160;  // of a dense crop
constexpr double kBytesPerFittedVertex = 200;
constexpr double kPerSparseVertex = 900, kPerSparseVoxel = 300, kPerSparseTriangle = 300;
constexpr double kBytesPerSparseTriangle = 200;
constexpr double kPerTriangle = 60;
constexpr double kPerGridVoxel = 12;
/// Streams in larger chunks are charged for the rest of the chunk: it may be decoded again.
constexpr double kFreeChunkBytes = 1 << 16;

double number(std::uint64_t n) {
  return static_cast<double>(n);
}

/// Bytes that fit_surface() or fit_normals() hold: the crop, and 23 floats per voxel of a slice.
double crop_bytes(const IndexBox& box) {
  const double voxels = number(crop_voxels(box));
  return voxels + 92 * voxels / static_cast<double>(box.last[2] - box.first[2] + 1);
}

std::vector<ClassId> all_classes(const Atlas& atlas) {
  std::vector<ClassId> all(atlas.classes().size());
  std::iota(all.begin(), all.end(), ClassId{0});
  return all;
}

}  // namespace

Work Atlas::Impl::work_of_stream(SectionKind kind, std::size_t stream) const {
  Work work;
  const SectionLayout* section = layout.find(kind);
  if (section == nullptr) return work;
  const std::uint64_t begin = section->stream_begin[stream], end = section->stream_begin[stream + 1];
  if (begin == end) return work;
  const auto& cuts = section->chunk_begin;
  const auto n = static_cast<std::size_t>(std::ranges::upper_bound(cuts, begin) - cuts.begin()) - 1;
  const double chunk = number(cuts[n + 1] - cuts[n]);
  const bool is_shared = cuts[n] < begin || cuts[n + 1] > end;
  const double others = is_shared ? std::max(0.0, chunk - number(end - begin) - kFreeChunkBytes) : 0;
  work.add(WorkKind::kBytes, number(end - begin) + others, kPerDecodedByte);
  work.hold(number(end - begin) + (is_shared ? 16 * chunk : 0));
  return work;
}

Work Atlas::Impl::work_of_runs(std::span<const ClassId> of, Axis axis, double further_per_run) const {
  // Reading never gives more runs than the directory states.
  const double total = number(directory.run_totals[static_cast<std::size_t>(axis)]);
  if (!layout.find(run_section(axis))) {
    Work work = work_of_runs(of, Axis::kZ);
    double voxels = 0;
    for (const ClassId c : of) {
      if (c != kEmptyClass) voxels += number(directory.classes.voxels(c));
    }
    work.add(WorkKind::kVoxels, voxels, kPerDerivedVoxel);
    work.add(WorkKind::kRuns, std::min(voxels, total), kPerRun + further_per_run);
    return work;
  }
  RunLists lists = run_lists(of, axis);
  lists.work.add(WorkKind::kRuns, lists.runs, kPerRun + further_per_run);
  return lists.work;
}

Atlas::Impl::RunLists Atlas::Impl::run_lists(std::span<const ClassId> of, Axis axis) const {
  RunLists lists;
  Work& work = lists.work;
  const double total = number(directory.run_totals[static_cast<std::size_t>(axis)]);
  for (std::size_t n = 0; n < of.size(); ++n) {
    ClassId c = of[n];
    if (c == kEmptyClass) continue;
    std::uint64_t voxels = directory.classes.voxels(c);
    if (shares_runs(c, axis)) {
      const auto pair = run_streams.pair_of(c);
      if (n > 0 && c == pair[1] && of[n - 1] == pair[0]) continue;  // the list is read once
      c = pair[0];
      voxels = directory.classes.voxels(pair[0]) + directory.classes.voxels(pair[1]);
    }
    work += work_of_stream(run_section(axis), c);
    double runs_of_list =
        std::min(number(voxels), directory.run_bytes[c][static_cast<std::size_t>(axis)] / 3.0);
    if (const IndexBox box = list_box(c, axis); codes_mask(box, voxels)) {
      work.add(WorkKind::kVoxels, number(box.voxels()), kPerMaskVoxel);
      runs_of_list = number(voxels);
    }
    runs_of_list = std::min(runs_of_list, total);
    work.hold(kBytesPerReadRun * runs_of_list);
    lists.runs += runs_of_list;
  }
  lists.runs = std::min(lists.runs, total);
  return lists;
}

Work Atlas::Impl::work_of_values(std::size_t group) const {
  Work work = work_of_stream(SectionKind::kValues, group);
  const std::uint64_t voxels = group_voxels(groups, directory.classes, group);
  const double bytes = number(voxels) * number(bytes_of(directory.value_type));
  if (bytes == 0) return work;
  double per_byte = kPerValueByte;
  if (predicts_values(directory.value_type, group_box(groups, directory.classes, group, grid.size), voxels))
    per_byte += kPerPredictedByte;
  work.add(WorkKind::kVoxels, number(voxels), per_byte * number(bytes_of(directory.value_type)));
  work.hold(3 * bytes);
  if (groups.classes[group].size() > 1 || groups.classes[group].front() == kEmptyClass)
    work += work_of_runs(groups.locating_classes(group), Axis::kZ);
  return work;
}

std::vector<ClassId> Atlas::Impl::classes_near(StructureIndex s, const IndexBox& near) const {
  constexpr std::size_t kMaxTested = 1024;  // structures with more classes are charged for all
  const std::span<const StructureClass> all = structure_classes.of(s);
  std::vector<ClassId> of;
  for (const StructureClass& h : all) {
    if (all.size() > kMaxTested || overlap(directory.classes.box(h.id), near)) of.push_back(h.id);
  }
  return of;
}

Work Atlas::Impl::work_of_crop(StructureIndex s, const IndexBox& near) const {
  return work_of_runs(classes_near(s, near), Axis::kZ);
}

Work Atlas::Impl::work_of_rows(StructureIndex s, const IndexBox& near, double bytes) const {
  RunLists lists = run_lists(classes_near(s, near), Axis::kZ);
  lists.work.add(WorkKind::kRuns, lists.runs, kPerRun);
  // Meanwhile, split lists are cached, and the last list is read
  lists.work.hold((PartRows::kMaxBytesPerRun + sizeof(Run) + kBytesPerReadRun) * lists.runs);
  lists.work.hold(kBytesPerSortedRun * lists.runs + bytes);
  return lists.work;
}

Work Atlas::Impl::work_of_normals(ClassId c) const {
  if (!has_normals(directory.classes, c)) return {};
  const double voxels = number(directory.classes.voxels(c));
  Work work;
  if (stores_normals(directory, c)) {
    work = work_of_stream(SectionKind::kNormals, c);
    work.add(WorkKind::kVoxels, voxels, kPerValueByte * sizeof(PackedNormal));
    return work;
  }
  const IndexBox& box = directory.classes.box(c);
  if (box.empty()) return work;
  const StructureIndex owner = normal_owner(directory.classes.members(c));
  if (fits_sparsely(box, directory.classes.voxels(c))) {
    work = work_of_rows(owner, around(box), 3 * sizeof(PackedNormal) * voxels);
    work.add(WorkKind::kVoxels, voxels, kPerSparseVoxel);
  } else {
    work = work_of_crop(owner, around(box));
    work.add(WorkKind::kVoxels, number(crop_voxels(box)), kPerCropVoxel);
    work.hold(crop_bytes(box));
  }
  return work;
}

Work Atlas::Impl::work_of_surface(StructureIndex s) const {
  const SurfaceEntry& entry = directory.surfaces[s];
  Work work;
  const double triangles = entry.triangles, vertices = entry.vertices;
  if (!is_fitted(entry)) {
    work.add(WorkKind::kTriangles, triangles, kPerTriangle);
    work += work_of_stream(SectionKind::kSurfaces, surface_stream[s]);
    return work;
  }
  const IndexBox box = box_of(directory.classes, structure_classes.of(s));
  double per_triangle = kPerTriangle;
  if (!box.empty() && fits_sparsely(box, entry.vertices)) {
    work = work_of_rows(s, box, kBytesPerSparseTriangle * triangles);
    per_triangle += kPerSparseTriangle + kPerSparseVertex * vertices / triangles;
  } else if (!box.empty()) {
    work = work_of_crop(s, box);
    work.add(WorkKind::kVoxels, number(crop_voxels(box)), kPerCropVoxel);
    work.hold(crop_bytes(box) + kBytesPerFittedVertex * vertices);
    per_triangle += kPerFittedVertex * vertices / triangles;
  }
  work.add(WorkKind::kTriangles, triangles, per_triangle);  // fitted surfaces have some
  return work;
}

Work Atlas::work_of_runs(std::span<const ClassId> of, Axis axis) const {
  return impl_->work_of_runs(of, axis);
}

Work Atlas::work_of_values(std::span<const ClassId> of) const {
  Work work;
  if (value_type() == VoxelType::kNone) return work;
  std::uint32_t latest = std::numeric_limits<std::uint32_t>::max();
  for (const ClassId c : of) {
    const std::uint32_t group = impl_->groups.group_of[c];
    if (group == latest) continue;  // decoded once
    latest = group;
    work += impl_->work_of_values(group);
  }
  return work;
}

Work Atlas::work_of_normals(ClassId c) const {
  return impl_->work_of_normals(c);
}

Work Atlas::work_of_surface(StructureIndex s) const {
  return impl_->work_of_surface(s);
}

Work Atlas::work_of_class_volume() const {
  Work work = work_of_runs(all_classes(*this), Axis::kZ);
  const auto voxels = static_cast<double>(grid().voxels());
  work.add(WorkKind::kVoxels, voxels, kPerGridVoxel);
  work.hold(voxels * sizeof(ClassId));
  return work;
}

Work Atlas::work_of_value_volume() const {
  Work work = work_of_values(all_classes(*this));
  work.hold(2 * static_cast<double>(grid().voxels()) * number(bytes_of(value_type())));
  return work;
}

Work Atlas::work_of_verify() const {
  Work work;
  for (const SectionLayout& section : impl_->layout.sections) {
    if (!section.chunk_begin.empty())
      work.add(WorkKind::kBytes, number(section.chunk_begin.back()), kPerDecodedByte);
  }
  const std::vector<ClassId> all = all_classes(*this);
  for (const Axis axis : kAxes) work += impl_->work_of_runs(all, axis, axis == Axis::kZ ? kPerSortedRun : 0);
  work.hold((kBytesPerVerifiedRun + kBytesPerReadRun) * number(runs(Axis::kZ)));
  work += work_of_values(all);
  for (StructureIndex s = 0; s < graph().size(); ++s) work += work_of_surface(s);
  return work;
}

const WorkBudget& Atlas::work_budget() const {
  return impl_->budget;
}

}  // namespace splatlas
