#include "tests/support/sparse_atlas.h"

#include <algorithm>
#include <string>

#include "format/atlas_writer.h"
#include "format/codec/run_codec.h"
#include "format/derive/fit_surface.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// As many structures, of one voxel each, in one row, and before them one of all these voxels.
AtlasContent content_in_a_row(std::size_t structures, bool in_one) {
  TestVolume volume;
  volume.grid.size = {static_cast<std::int64_t>(3 * structures + 1), 1, 1};
  if (in_one) {
    volume.structures.push_back(
        {"all", make_mask(volume.grid.size, [](std::int64_t i, auto...) { return i % 3 == 1; })});
  }
  for (std::size_t s = 0; s < structures; ++s) {
    const auto at = static_cast<std::int64_t>(3 * s + 1);
    volume.structures.push_back(
        {"s" + std::to_string(s), box_mask(volume.grid.size, {at, 0, 0}, {at, 0, 0})});
  }
  return make_content(volume);
}

/// The runs of all voxels of the boxes.
ClassRuns runs_of(const SparseStructure& boxes, const Index3& size, Axis axis) {
  const ScanOrder order = ScanOrder::of(axis);
  ClassRuns runs;
  for (const IndexBox& box : boxes) {
    for (std::int64_t slice = box.first[order.slice_axis]; slice <= box.last[order.slice_axis]; ++slice) {
      for (std::int64_t row = box.first[order.row_axis]; row <= box.last[order.row_axis]; ++row) {
        const std::int64_t start = box.first[order.scan_axis], last = box.last[order.scan_axis];
        runs.push_back({static_cast<std::uint64_t>(slice * size[order.row_axis] + row),
                        static_cast<std::uint32_t>(start), static_cast<std::uint32_t>(last - start + 1)});
      }
    }
  }
  std::ranges::sort(runs);
  return runs;
}

/// Counts of the surface around a box of voxels, by marching cubes on a crop of its own.
SurfaceEntry entry_of(const SparseStructure& boxes) {
  SurfaceEntry entry;
  for (const IndexBox& box : boxes) {
    // The counts do not depend on the place. A box of n voxels has as many vertices as faces.
    const Index3 size{box.last[0] - box.first[0] + 1, box.last[1] - box.first[1] + 1,
                      box.last[2] - box.first[2] + 1};
    const std::int64_t faces = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    entry.vertices += static_cast<std::uint32_t>(faces);
    entry.triangles += static_cast<std::uint32_t>(2 * faces - 4);
  }
  return entry;
}

}  // namespace

bool are_near(const IndexBox& a, const IndexBox& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (a.last[axis] + 3 < b.first[axis] || b.last[axis] + 3 < a.first[axis]) return false;
  }
  return true;
}

std::vector<std::byte> sparse_atlas(const Index3& size, const std::vector<SparseStructure>& structures,
                                    bool in_one) {
  AtlasParts parts = take_apart(encode_atlas(content_in_a_row(structures.size(), in_one)).value());
  Directory& directory = parts.directory;
  directory.source_grid.size = size;
  directory.source_to_storage = AxisOrder{};
  directory.label_type = VoxelType::kUInt32;
  std::vector<Structure> named(directory.graph.structures().begin(), directory.graph.structures().end());
  for (std::size_t s = 0; s < named.size(); ++s) named[s].label = static_cast<std::int64_t>(s + 1);
  directory.graph = StructureGraph::build(std::move(named)).value();
  const Vec3 center{0.5 * static_cast<double>(size[0] - 1), 0.5 * static_cast<double>(size[1] - 1),
                    0.5 * static_cast<double>(size[2] - 1)};
  directory.display.center_lps_mm = center;
  directory.display.radius_mm = center[0] + center[1] + center[2] + 1;

  // Classes are in the order of structures
  const RunFingerprinter fingerprinter(size);
  std::uint64_t empty = static_cast<std::uint64_t>(directory.source_grid.voxels());
  ClassTable classes;
  directory.fingerprints.assign(directory.classes.size(), fingerprinter.of_grid());
  std::array<std::vector<Bytes>, 3> streams;
  for (const Axis axis : kAxes) {
    const auto a = static_cast<std::size_t>(axis);
    streams[a].resize(directory.classes.size());
    directory.run_totals[a] = 0;
  }
  for (std::size_t s = 0; s < structures.size(); ++s) {
    const auto c = static_cast<ClassId>(s + 1);
    const auto members = directory.classes.members(c);
    std::uint64_t voxels = 0;
    IndexBox box;
    for (const IndexBox& of : structures[s]) {
      voxels += static_cast<std::uint64_t>((of.last[0] - of.first[0] + 1) * (of.last[1] - of.first[1] + 1) *
                                           (of.last[2] - of.first[2] + 1));
      box.include(of);
    }
    classes.count(classes.intern({members.begin(), members.end()}), voxels, box);
    empty -= voxels;
    for (const Axis axis : kAxes) {
      const auto a = static_cast<std::size_t>(axis);
      const ClassRuns runs = runs_of(structures[s], size, axis);
      append_run_list(runs, streams[a][c]);
      directory.run_bytes[c][a] = static_cast<std::uint32_t>(streams[a][c].size());
      directory.run_totals[a] += runs.size();
      directory.fingerprints[c] = fingerprinter.of(runs, axis);
    }
    directory.fingerprints[0] = subtract_fingerprints(directory.fingerprints[0], directory.fingerprints[c]);
    SurfaceEntry& entry = directory.surfaces[members.back().structure];
    entry = entry_of(structures[s]);
    if (in_one) {
      SurfaceEntry& all = directory.surfaces[members.front().structure];
      if (s == 0) all = {};
      all.vertices += entry.vertices;
      all.triangles += entry.triangles;
      all.position_scale = static_cast<std::uint32_t>(rule_for(SurfaceRule::kSmooth, Grid{.size = size}));
    }
    constexpr std::array kRules{SurfaceRule::kVoxels, SurfaceRule::kSmooth, SurfaceRule::kUneven};
    entry.position_scale = static_cast<std::uint32_t>(kRules[admits(size, kRules[1]) ? s % 3 : 0]);
    directory.normals_fitted[c] = true;
  }
  classes.count(kEmptyClass, empty, {});
  directory.classes = classes;
  for (const Axis axis : kAxes)
    replace_streams(parts, run_section(axis), streams[static_cast<std::size_t>(axis)]);
  for (const SectionKind kind : {SectionKind::kNormals, SectionKind::kSurfaces}) {
    const std::vector<Bytes> none(kind == SectionKind::kNormals ? directory.classes.size()
                                                                : directory.surfaces.size());
    const bool has =
        std::ranges::count(directory.sections, static_cast<std::uint32_t>(kind), &SectionEntry::kind) != 0;
    if (has) replace_streams(parts, kind, none);
  }
  return put_together(parts);
}

}  // namespace splatlas
