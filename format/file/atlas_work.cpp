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

}  // namespace

std::vector<ClassId> Atlas::Impl::all_classes() const {
  std::vector<ClassId> all(directory.classes.size());
  std::iota(all.begin(), all.end(), ClassId{0});
  return all;
}

std::vector<StructureIndex> Atlas::Impl::all_structures() const {
  std::vector<StructureIndex> all(directory.graph.size());
  std::iota(all.begin(), all.end(), StructureIndex{0});
  return all;
}

double Atlas::Impl::total_runs(Axis axis) const {
  return number(directory.run_totals[static_cast<std::size_t>(axis)]);
}

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
  if (!layout.find(run_section(axis))) {
    double voxels = 0;
    for (const ClassId c : of) {
      if (c != kEmptyClass) voxels += number(directory.classes.voxels(c));
    }
    Work derived;
    derived.add(WorkKind::kVoxels, voxels, kPerDerivedVoxel);
    derived.add(WorkKind::kRuns, std::min(voxels, total_runs(axis)), kPerRun + further_per_run);
    return work_of_runs(of, Axis::kZ).then(derived);
  }
  RunLists lists = run_lists(of, axis);
  lists.work.add(WorkKind::kRuns, lists.runs, kPerRun + further_per_run);
  return lists.work;
}

Atlas::Impl::RunLists Atlas::Impl::run_lists(std::span<const ClassId> of, Axis axis) const {
  RunLists lists;
  Work& work = lists.work;
  const double total = total_runs(axis);
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
    if (const IndexBox box = list_box(c, axis); voxels > 0 && codes_mask(box, voxels)) {
      work.add(WorkKind::kVoxels, number(voxels), kPerMaskVoxel * number(box.voxels()) / number(voxels));
      runs_of_list = number(voxels);
    }
    runs_of_list = std::min(runs_of_list, total);
    work.hold(kBytesPerReadRun * runs_of_list);
    lists.runs += runs_of_list;
  }
  lists.runs = std::min(lists.runs, total);
  return lists;
}

Atlas::Impl::GroupWork Atlas::Impl::work_of_values(std::size_t group) const {
  GroupWork work{work_of_stream(SectionKind::kValues, group), {}};
  const std::uint64_t voxels = group_voxels(groups, directory.classes, group);
  const double bytes = number(voxels) * number(bytes_of(directory.value_type));
  if (bytes == 0) return work;
  const bool is_predicted =
      predicts_values(directory.value_type, group_box(groups, directory.classes, group, grid.size), voxels);
  const double per_byte = kPerValueByte + (is_predicted ? kPerPredictedByte : 0);
  work.decoding.add(WorkKind::kVoxels, number(voxels), per_byte * number(bytes_of(directory.value_type)));
  work.decoding.hold(3 * bytes);
  if (is_predicted || groups.classes[group].size() > 1)  // as in decode_group()
    work.locating = work_of_runs(groups.locating_classes(group), Axis::kZ);
  return work;
}

std::vector<ClassId> Atlas::Impl::lists_near(StructureIndex s, const IndexBox& near) const {
  constexpr std::size_t kMaxTested = 1024;  // structures with more classes are charged for all
  const std::span<const StructureClass> all = structure_classes.of(s);
  std::vector<ClassId> lists;
  for (const StructureClass& h : all) {
    if (shares_runs(h.id, Axis::kZ) && h.id != run_streams.pair_of(h.id)[0]) continue;
    if (all.size() > kMaxTested || overlap(list_box(h.id, Axis::kZ), near)) lists.push_back(h.id);
  }
  return lists;
}

double Atlas::Impl::add_lists(StructureIndex s, const IndexBox& near, FitWork& sum) const {
  sum.counted.resize(directory.classes.size());
  std::vector<ClassId> others, counted;
  for (const ClassId c : lists_near(s, near)) {
    (sum.counted[c] ? counted : others).push_back(c);
    sum.counted[c] = true;
  }
  RunLists first = run_lists(others, Axis::kZ), again = run_lists(counted, Axis::kZ);
  for (RunLists* lists : {&first, &again}) lists->work.add(WorkKind::kRuns, lists->runs, kPerRun);
  sum.reading += first.work;
  sum.reading.then(again.work);
  return std::min(first.runs + again.runs, total_runs(Axis::kZ));
}

void Atlas::Impl::add_rows(StructureIndex s, const IndexBox& near, double bytes, FitWork& sum) const {
  const double runs = add_lists(s, near, sum);
  // Meanwhile, split lists are cached, and the last list is read
  sum.reading.hold((PartRows::kMaxBytesPerRun + sizeof(Run) + kBytesPerReadRun) * runs);
  sum.reading.hold(kBytesPerSortedRun * runs + bytes);
}

void Atlas::Impl::add_normals(ClassId c, FitWork& sum) const {
  if (!has_normals(directory.classes, c)) return;
  const double voxels = number(directory.classes.voxels(c));
  if (stores_normals(directory, c)) {
    sum.deriving += work_of_stream(SectionKind::kNormals, c);
    sum.deriving.add(WorkKind::kVoxels, voxels, kPerValueByte * sizeof(PackedNormal));
    return;
  }
  const IndexBox& box = directory.classes.box(c);
  if (box.empty()) return;
  const StructureIndex owner = normal_owner(directory.classes.members(c));
  if (fits_sparsely(box, directory.classes.voxels(c))) {
    add_rows(owner, around(box), 3 * sizeof(PackedNormal) * voxels, sum);
    sum.deriving.add(WorkKind::kVoxels, voxels, kPerSparseVoxel);
  } else {
    add_lists(owner, around(box), sum);
    sum.deriving.add(WorkKind::kVoxels, voxels, kPerCropVoxel * number(crop_voxels(box)) / voxels);
    sum.deriving.hold(crop_bytes(box));
  }
}

void Atlas::Impl::add_surface(StructureIndex s, FitWork& sum) const {
  const SurfaceEntry& entry = directory.surfaces[s];
  const double triangles = entry.triangles, vertices = entry.vertices;
  if (!is_fitted(entry)) {
    sum.deriving.add(WorkKind::kTriangles, triangles, kPerTriangle);
    sum.deriving += work_of_stream(SectionKind::kSurfaces, surface_stream[s]);
    return;
  }
  // Fitted surfaces have triangles
  const IndexBox box = box_of(directory.classes, structure_classes.of(s));
  double per_triangle = kPerTriangle;
  if (!box.empty() && fits_sparsely(box, entry.vertices)) {
    add_rows(s, box, kBytesPerSparseTriangle * triangles, sum);
    per_triangle += kPerSparseTriangle + kPerSparseVertex * vertices / triangles;
  } else if (!box.empty()) {
    add_lists(s, box, sum);
    const double crop = number(crop_voxels(box));
    per_triangle += (kPerCropVoxel * crop + kPerFittedVertex * vertices) / triangles;
    sum.deriving.hold(crop_bytes(box) + kBytesPerFittedVertex * vertices);
  }
  sum.deriving.add(WorkKind::kTriangles, triangles, per_triangle);
}

Work Atlas::work_of_runs(std::span<const ClassId> of, Axis axis) const {
  return impl_->work_of_runs(of, axis);
}

Work Atlas::work_of_values(std::span<const ClassId> of) const {
  Impl::GroupWork sum;
  if (value_type() == VoxelType::kNone) return {};
  const std::uint32_t of_empty = impl_->groups.group_of[kEmptyClass];
  std::vector<bool> counted(impl_->groups.size());
  std::uint32_t latest = std::numeric_limits<std::uint32_t>::max();
  Work again;  // of items that are counted in the sum
  for (const ClassId c : of) {
    const std::uint32_t group = impl_->groups.group_of[c];
    if (group == latest) continue;  // decoded once
    latest = group;
    const Impl::GroupWork work = impl_->work_of_values(group);
    if (counted[group]) {
      again.then(work.decoding).then(work.locating);
    } else {
      sum.decoding += work.decoding;
      // The runs of all classes locate the values of the empty class
      group == of_empty ? again.then(work.locating) : sum.locating += work.locating;
    }
    counted[group] = true;
  }
  sum.locating.limit(WorkKind::kRuns, impl_->total_runs(Axis::kZ));
  return sum.decoding.then(sum.locating).then(again);
}

Work Atlas::work_of_normals(std::span<const ClassId> of) const {
  Impl::FitWork sum;
  for (const ClassId c : of) impl_->add_normals(c, sum);
  sum.reading.limit(WorkKind::kRuns, impl_->total_runs(Axis::kZ));
  return sum.reading.then(sum.deriving);
}

Work Atlas::work_of_surfaces(std::span<const StructureIndex> of) const {
  Impl::FitWork sum;
  for (const StructureIndex s : of) impl_->add_surface(s, sum);
  sum.reading.limit(WorkKind::kRuns, impl_->total_runs(Axis::kZ));
  return sum.reading.then(sum.deriving);
}

Work Atlas::work_of_class_volume() const {
  Work filling;
  const auto voxels = static_cast<double>(grid().voxels());
  filling.add(WorkKind::kVoxels, voxels, kPerGridVoxel);
  filling.hold(voxels * sizeof(ClassId));
  return work_of_runs(impl_->all_classes(), Axis::kZ).then(filling);
}

Work Atlas::work_of_value_volume() const {
  Work work = work_of_values(impl_->all_classes());
  work.hold(2 * static_cast<double>(grid().voxels()) * number(bytes_of(value_type())));
  return work;
}

Work Atlas::work_of_all() const {
  Work work = work_of_class_volume();
  work.then(work_of_value_volume());
  work.then(work_of_surfaces(impl_->all_structures()));
  return work.then(work_of_normals(impl_->all_classes()));
}

Work Atlas::work_of_verify() const {
  Work work;
  for (const SectionLayout& section : impl_->layout.sections) {
    if (!section.chunk_begin.empty())
      work.add(WorkKind::kBytes, number(section.chunk_begin.back()), kPerDecodedByte);
  }
  const std::vector<ClassId> all = impl_->all_classes();
  for (const Axis axis : kAxes)
    work.then(impl_->work_of_runs(all, axis, axis == Axis::kZ ? kPerSortedRun : 0));
  work.hold((kBytesPerVerifiedRun + kBytesPerReadRun) * impl_->total_runs(Axis::kZ));
  work.then(work_of_values(all));
  return work.then(work_of_surfaces(impl_->all_structures()));
}

const WorkBudget& Atlas::work_budget() const {
  return impl_->budget;
}

}  // namespace splatlas
