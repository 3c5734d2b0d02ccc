#include "player/frame/fit_selection.h"

#include <algorithm>
#include <vector>

#include "player/spans/selected_runs.h"

namespace splatlas {
namespace {

/// Distance of interpolation from the centre of a voxel, along each axis.
constexpr double kVolumeReach = 1;
constexpr std::size_t kVerticesPerJob = 16384;

/// Extents of the centres of a slice's voxels. Only the ends of a scanline matter.
FitExtents extents_of_slice(const SelectedRuns& runs, std::int64_t slice, const FitPlanes& planes) {
  const ScanOrder order = ScanOrder::of(runs.axis());
  FitExtents extents;
  ClassRun line{};  // from the first to the last voxel of a row
  const auto finish_line = [&] {
    if (line.length == 0) return;
    Vec3 end{};
    end[order.slice_axis] = static_cast<double>(slice);
    end[order.row_axis] = line.row;
    end[order.scan_axis] = line.start;
    extents.include(planes, end);
    end[order.scan_axis] = static_cast<double>(line.start) + line.length - 1;
    extents.include(planes, end);
  };
  runs.for_each(slice, [&](const ClassRun& run, std::uint32_t) {
    if (line.length > 0 && run.row == line.row) {
      line.length = run.start + run.length - line.start;
      return;
    }
    finish_line();
    line = run;
  });
  finish_line();
  return extents;
}

FitExtents extents_of_volume(const SelectedRuns& runs, const FitPlanes& planes, ThreadPool& pool) {
  const std::span<const std::int64_t> slices = runs.occupied();
  std::vector<FitExtents> of_slices(slices.size());
  pool.for_each(slices.size(),
                [&](std::size_t n) { of_slices[n] = extents_of_slice(runs, slices[n], planes); });
  FitExtents extents;
  for (const FitExtents& of_slice : of_slices) extents.include(of_slice);
  if (!extents.empty()) extents.grow(planes, kVolumeReach);
  return extents;
}

FitExtents extents_of_surface(const SurfaceMesh& mesh, const FitPlanes& planes, ThreadPool& pool) {
  const auto& positions = mesh.positions_ijk;
  std::vector<FitExtents> of_jobs((positions.size() + kVerticesPerJob - 1) / kVerticesPerJob);
  pool.for_each(of_jobs.size(), [&](std::size_t job) {
    const std::size_t end = std::min(positions.size(), (job + 1) * kVerticesPerJob);
    for (std::size_t n = job * kVerticesPerJob; n < end; ++n) {
      of_jobs[job].include(planes, {positions[n][0], positions[n][1], positions[n][2]});
    }
  });
  FitExtents extents;
  for (const FitExtents& of_job : of_jobs) extents.include(of_job);
  return extents;
}

}  // namespace

DrawPlan part_of(const DrawPlan& plan, std::span<const StructureIndex> structures, const Atlas& atlas) {
  std::vector<bool> wanted(atlas.graph().size());
  for (const StructureIndex s : structures) {
    if (s < wanted.size()) wanted[s] = true;
  }
  DrawPlan part;
  for (const ClassDraw& draw : plan.classes) {
    const auto members = atlas.classes().members(draw.id);
    const auto is_wanted = [&](const Membership& of) { return of.holds() && wanted[of.structure]; };
    if (std::ranges::any_of(members, is_wanted)) part.classes.push_back(draw);
  }
  for (const StructureIndex s : plan.surfaces) {
    if (wanted[s]) part.surfaces.push_back(s);
  }
  return part;
}

FitExtents extents_of(const DrawPlan& plan, const Atlas& atlas, const ClassCache& cache, Axis axis,
                      const FitPlanes& planes, ThreadPool& pool) {
  FitExtents extents;
  if (!volume_classes(plan).empty()) {
    extents = extents_of_volume(SelectedRuns(plan, atlas.classes(), cache, axis), planes, pool);
  }
  for (const StructureIndex s : plan.surfaces) {
    extents.include(extents_of_surface(cache.surface(s), planes, pool));
  }
  return extents;
}

}  // namespace splatlas
