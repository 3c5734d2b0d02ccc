// validate(Directory), used by the writer and the reader.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include <fmt/format.h>

#include "format/codec/run_codec.h"
#include "format/codec/surface_codec.h"
#include "format/derive/boundary_split.h"
#include "format/derive/value_groups.h"
#include "format/file/directory.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {

namespace {

bool all_finite(std::initializer_list<double> values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

/// `describe` returns the name of the text for the message.
template <typename Describe>
Result<void> check_text(std::string_view text, const Describe& describe) {
  const std::string fault = fault_of_text(text);
  if (fault.empty()) return {};
  return invalid_atlas("invalid: {} {}", describe(), fault);
}

Result<void> check_texts(const Directory& d) {
  const Provenance& p = d.provenance;
  for (const auto* text : {&p.title, &p.citation, &p.licence, &p.tool}) {
    SPLATLAS_RETURN_IF_ERROR(check_text(*text, [] { return std::string("provenance"); }));
  }
  for (const Source& source : p.sources) {
    SPLATLAS_RETURN_IF_ERROR(check_text(source.role, [] { return std::string("a source's role"); }));
    SPLATLAS_RETURN_IF_ERROR(check_text(source.hash, [] { return std::string("a source's hash"); }));
  }
  for (StructureIndex s = 0; s < d.graph.size(); ++s) {
    SPLATLAS_RETURN_IF_ERROR(check_text(d.graph[s].id, [s] { return fmt::format("id of structure {}", s); }));
    SPLATLAS_RETURN_IF_ERROR(
        check_text(d.graph[s].name, [s] { return fmt::format("name of structure {}", s); }));
    for (const Term& term : d.graph[s].terms) {
      for (const auto* text : {&term.vocabulary, &term.value})
        SPLATLAS_RETURN_IF_ERROR(check_text(*text, [s] { return fmt::format("term of structure {}", s); }));
    }
  }
  for (std::size_t n = 0; n < d.scenes.size(); ++n) {
    const Scene& scene = d.scenes[n];
    for (const auto* text :
         {&scene.name, &scene.caption, &scene.selection, &scene.question, &scene.cuts, &scene.center}) {
      SPLATLAS_RETURN_IF_ERROR(check_text(*text, [n] { return fmt::format("text of scene {}", n); }));
    }
    for (const std::string& label : scene.labels)
      SPLATLAS_RETURN_IF_ERROR(check_text(label, [n] { return fmt::format("text of scene {}", n); }));
    if (!all_finite({scene.azimuth_deg, scene.elevation_deg, scene.zoom}) || !(scene.zoom > 0)) {
      return invalid_atlas("invalid: camera of scene {}: azimuth {}, elevation {}, zoom {}", n,
                           scene.azimuth_deg, scene.elevation_deg, scene.zoom);
    }
  }
  return {};
}

Result<void> check_geometry(const Directory& d) {
  if (auto valid = validate(d.source_grid, "source grid"); !valid)
    return invalid_atlas("invalid: {}", valid.error().message);
  if (!d.source_to_storage.is_permutation()) return invalid_atlas("invalid: axis order is not a permutation");
  for (const VoxelType type : {d.value_type, d.label_type}) {
    if (static_cast<unsigned>(type) > static_cast<unsigned>(VoxelType::kFloat64)) {
      return invalid_atlas("invalid: unknown voxel type {}", static_cast<unsigned>(type));
    }
  }
  const Display& view = d.display;
  if (!all_finite({view.window_low, view.window_high}) || !is_within_reach(view.center_lps_mm) ||
      !(view.radius_mm >= 0 && view.radius_mm <= kMaxMm)) {
    return invalid_atlas("invalid: display: window {} to {}, ball at {}, {}, {} of radius {}",
                         view.window_low, view.window_high, view.center_lps_mm[0], view.center_lps_mm[1],
                         view.center_lps_mm[2], view.radius_mm);
  }
  return {};
}

/// True if the box is inside the grid and large enough for the voxels. Classes without voxels have no box;
/// the empty class may have none.
bool box_fits(const IndexBox& box, std::uint64_t voxels, bool may_be_empty, const Index3& size) {
  if (box == IndexBox{}) return voxels == 0 || may_be_empty;
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.first[a] < 0 || box.first[a] > box.last[a] || box.last[a] >= size[a]) return false;
  }
  return voxels > 0 && voxels <= box.voxels();
}

Result<void> check_classes(const Directory& d, const Grid& grid) {
  if (!d.classes.members(kEmptyClass).empty()) return invalid_atlas("invalid: class 0 has members");
  std::uint64_t sum = 0;
  const auto grid_voxels = static_cast<std::uint64_t>(grid.voxels());
  for (ClassId c = 0; c < d.classes.size(); ++c) {
    const std::uint64_t voxels = d.classes.voxels(c);
    if (voxels > grid_voxels - sum)
      return invalid_atlas("invalid: classes have more voxels than the grid's {}", grid_voxels);
    sum += voxels;
    if (!box_fits(d.classes.box(c), voxels, c == kEmptyClass, grid.size)) {
      return invalid_atlas("invalid: box of class {} does not fit its {} voxels in the grid", c, voxels);
    }
  }
  if (sum != grid_voxels) {
    return invalid_atlas("invalid: classes have {} voxels, the grid has {}", sum, grid_voxels);
  }
  return {};
}

Result<void> check_runs(const Directory& d, const RunStreams& streams) {
  for (const Axis axis : kAxes) {
    const auto a = static_cast<std::size_t>(axis);
    const bool stored = std::ranges::count(d.sections, static_cast<std::uint32_t>(run_section(axis)),
                                           &SectionEntry::kind) != 0;
    const std::uint64_t covered =
        static_cast<std::uint64_t>(d.source_grid.voxels()) - d.classes.voxels(kEmptyClass);
    if (d.run_totals[a] > covered) {
      return invalid_atlas("invalid: run model {} has {} runs of {} voxels", a, d.run_totals[a], covered);
    }
    const auto bytes_of = [&](ClassId c) { return d.run_bytes[c][a]; };
    for (ClassId c = 0; c < d.classes.size(); ++c) {
      const std::uint64_t bytes = bytes_of(c);
      std::uint64_t voxels = c == kEmptyClass || !stored ? 0 : d.classes.voxels(c);
      if (stored && streams.is_shared(d.classes, c, bytes_of)) {  // the list of the first class covers both
        const auto pair = streams.pair_of(c);
        voxels = c == pair[0] ? voxels + d.classes.voxels(pair[1]) : 0;
      }
      if (bytes < min_run_list_bytes(voxels) || bytes > max_run_list_bytes(voxels)) {
        return invalid_atlas("invalid: runs of class {} along axis {} take {} bytes for {} voxels", c, a,
                             bytes, voxels);
      }
    }
  }
  return {};
}

Result<void> check_normals(const Directory& d) {
  if (d.normals_fitted.size() != d.classes.size()) {
    return invalid_atlas("invalid: normals of {} classes, there are {}", d.normals_fitted.size(),
                         d.classes.size());
  }
  for (ClassId c = 0; c < d.classes.size(); ++c) {
    if (d.normals_fitted[c] && !has_normals(d.classes, c)) {
      return invalid_atlas("invalid: class {} has fitted normals but no boundary", c);
    }
  }
  return {};
}

/// Fingerprints must add up to that of the grid: classes partition the voxels.
Result<void> check_fingerprints(const Directory& d, const Grid& grid) {
  if (d.fingerprints.size() != d.classes.size()) {
    return invalid_atlas("invalid: {} fingerprints of {} classes", d.fingerprints.size(), d.classes.size());
  }
  VoxelSetFingerprint sum = 0;
  for (ClassId c = 0; c < d.classes.size(); ++c) {
    if (!is_fingerprint(d.fingerprints[c]))
      return invalid_atlas("invalid: fingerprint {} of class {}", d.fingerprints[c], c);
    if (d.fingerprints[c] != 0 && d.classes.voxels(c) == 0) {
      return invalid_atlas("invalid: fingerprint {} of class {}, which has no voxels", d.fingerprints[c], c);
    }
    sum = add_fingerprints(sum, d.fingerprints[c]);
  }
  if (sum == RunFingerprinter(grid.size).of_grid()) return {};
  return invalid_atlas("invalid: fingerprints of classes do not add up to that of the grid");
}

/// [structure]: its voxels.
std::vector<std::uint64_t> voxels_of_structures(const Directory& d) {
  std::vector<std::uint64_t> voxels(d.graph.size(), 0);
  for (ClassId c = 0; c < d.classes.size(); ++c) {
    for (const Membership& m : d.classes.members(c)) {
      if (m.holds()) voxels[m.structure] += d.classes.voxels(c);
    }
  }
  return voxels;
}

/// A vertex of a fitted surface lies on one of the six grid edges of a voxel, and in one loop of each of the
/// four cells around that edge.
bool counts_fit(const SurfaceEntry& entry, std::uint64_t voxels) {
  return entry.vertices <= 6 * voxels && entry.triangles / 4 < entry.vertices;
}

Result<void> check_surfaces(const Directory& d, const Grid& grid) {
  if (d.surfaces.size() != d.graph.size()) {
    return invalid_atlas("invalid: {} surfaces of {} structures", d.surfaces.size(), d.graph.size());
  }
  const std::vector<std::uint64_t> voxels = voxels_of_structures(d);
  for (StructureIndex s = 0; s < d.graph.size(); ++s) {
    const SurfaceEntry& entry = d.surfaces[s];
    if (auto fits = check_surface_entry(entry, grid.size); !fits) {
      return invalid_atlas("invalid: surface of structure '{}': {}", d.graph[s].id, fits.error().message);
    }
    if (is_fitted(entry) && !counts_fit(entry, voxels[s])) {
      return invalid_atlas("invalid: surface of structure '{}': {} vertices and {} triangles for {} voxels",
                           d.graph[s].id, entry.vertices, entry.triangles, voxels[s]);
    }
  }
  return {};
}

Result<void> check_means(const Directory& d, const ValueGroups& groups, const Grid& grid) {
  const bool has_section = std::ranges::count(d.sections, static_cast<std::uint32_t>(SectionKind::kMeans),
                                              &SectionEntry::kind) != 0;
  if (has_section && d.value_type == VoxelType::kNone)
    return invalid_atlas("invalid: means without a value type");
  const std::size_t expected = has_section ? groups.size() : 0;
  if (d.mean_blocks.size() != expected) {
    return invalid_atlas("invalid: numbers of means of {} groups, expected {}", d.mean_blocks.size(),
                         expected);
  }
  for (std::size_t g = 0; g < expected; ++g) {
    const std::uint64_t voxels = group_voxels(groups, d.classes, g), blocks = d.mean_blocks[g];
    if (blocks == 0) continue;
    const IndexBox box = group_box(groups, d.classes, g, grid.size);
    if (g == groups.group_of[kEmptyClass] || !may_have_means(box) || blocks > voxels ||
        blocks << (3 * kMeanLevel) < voxels || blocks > box_of_blocks(box).voxels()) {
      return invalid_atlas("invalid: {} means of the {} voxels of class {}", d.mean_blocks[g], voxels,
                           groups.classes[g].front());
    }
  }
  return {};
}

}  // namespace

Result<void> validate(const Directory& d) {
  return validate(d, RunStreams(d.classes));
}

Result<void> validate(const Directory& d, const RunStreams& streams) {
  SPLATLAS_RETURN_IF_ERROR(check_geometry(d));
  SPLATLAS_RETURN_IF_ERROR(check_texts(d));
  const Grid grid = reordered(d.source_grid, d.source_to_storage);
  if (auto valid = validate(grid, "storage grid"); !valid)
    return invalid_atlas("invalid: {}", valid.error().message);
  SPLATLAS_RETURN_IF_ERROR(check_classes(d, grid));
  SPLATLAS_RETURN_IF_ERROR(check_fingerprints(d, grid));
  SPLATLAS_RETURN_IF_ERROR(check_runs(d, streams));
  SPLATLAS_RETURN_IF_ERROR(check_normals(d));
  SPLATLAS_RETURN_IF_ERROR(check_surfaces(d, grid));
  SPLATLAS_RETURN_IF_ERROR(check_means(d, streams.groups(), grid));
  return {};
}

}  // namespace splatlas
