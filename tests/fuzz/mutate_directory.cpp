#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tests/fuzz/mutators.h"

namespace splatlas {
namespace {

void mutate_text(std::string& text, Random& random) {
  static const std::array<const char*, 8> kTexts{"",     "*",  "a/b",  "\"", "x:volume(opacity=0.5)",
                                                 "\xff", "\n", "Größe"};
  if (text.empty() || below(2, random) == 0) {
    text.insert(below(text.size() + 1, random), kTexts[below(kTexts.size(), random)]);
  } else if (below(2, random) == 0) {
    text.erase(below(text.size(), random), 1 + below(4, random));
  } else {
    text[below(text.size(), random)] = static_cast<char>(random());
  }
}

void mutate_grid(Directory& d, Random& random) {
  const std::size_t a = below(3, random);
  if (below(5, random) == 0) {
    std::swap(d.source_to_storage.from[a], d.source_to_storage.from[below(3, random)]);
    d.source_to_storage.flipped[below(3, random)] ^= true;
  } else {
    Grid& grid = d.source_grid;
    mutate_any(random, grid.size[a], grid.spacing_mm[a], grid.origin_lps_mm[a],
               grid.direction_lps[below(9, random)]);
  }
}

void mutate_display(Display& display, Random& random) {
  mutate_any(random, display.window_low, display.window_high, display.center_lps_mm[below(3, random)],
             display.radius_mm);
}

void mutate_type(VoxelType& type, Random& random) {
  type = static_cast<VoxelType>(below(10, random));
}

/// Leaves graphs that cannot be built as they are.
void mutate_structures(Directory& d, Random& random) {
  std::vector<Structure> structures(d.graph.structures().begin(), d.graph.structures().end());
  if (structures.empty()) return;
  Structure& s = any_of(structures, random);
  switch (below(6, random)) {
    case 0: s.external = !s.external; break;
    case 1: mutate_text(s.name, random); break;
    case 2: s.id += "x"; break;
    case 4:
      s.terms.push_back({"SNOMED", s.name});
      mutate_text(any_of(s.terms, random).value, random);
      break;
    case 3: s.parents.push_back(static_cast<StructureIndex>(below(structures.size(), random))); break;
    default: s.parents.clear(); break;
  }
  if (auto graph = StructureGraph::build(std::move(structures))) d.graph = std::move(*graph);
}

struct ClassRow {
  std::vector<Membership> members;
  std::uint64_t voxels = 0;
  IndexBox box;
};

void mutate_row(ClassRow& row, std::size_t structures, Random& random) {
  if (below(4, random) != 0) {
    const std::size_t a = below(3, random);
    mutate_any(random, row.voxels, row.box.first[a], row.box.last[a]);
  } else if (row.members.empty() || below(2, random) == 0) {
    if (structures == 0) return;
    row.members.push_back({static_cast<StructureIndex>(below(structures, random)), Part::kBoundary});
  } else if (Membership& member = any_of(row.members, random); below(2, random) == 0) {
    member.part = static_cast<Part>(below(3, random));
  } else {
    member = row.members.back();
    row.members.pop_back();
  }
}

/// Half of the time the empty class absorbs the difference in voxels. Tables that repeat a class stay.
void mutate_classes(Directory& d, Random& random) {
  std::vector<ClassRow> rows;
  for (ClassId c = 0; c < d.classes.size(); ++c) {
    const auto members = d.classes.members(c);
    rows.push_back({{members.begin(), members.end()}, d.classes.voxels(c), d.classes.box(c)});
  }
  ClassRow& row = any_of(rows, random);
  const std::uint64_t before = row.voxels;
  mutate_row(row, d.graph.size(), random);
  if (below(2, random) == 0) rows[kEmptyClass].voxels += before - row.voxels;
  ClassTable table;
  for (ClassId c = 0; c < rows.size(); ++c) {
    if (table.intern(rows[c].members) != c) return;
    table.count(c, rows[c].voxels, rows[c].box);
  }
  d.classes = std::move(table);
}

void mutate_lengths(Directory& d, Random& random) {
  switch (below(4, random)) {
    case 0:
      if (!d.fingerprints.empty()) return mutate_number(any_of(d.fingerprints, random), random);
      [[fallthrough]];
    case 1: mutate_number(any_of(d.run_bytes, random)[below(3, random)], random); break;
    case 2: mutate_number(d.run_totals[below(3, random)], random); break;
    default: d.normals_fitted[below(d.normals_fitted.size(), random)].flip(); break;
  }
}

void mutate_surface(Directory& d, Random& random) {
  if (d.surfaces.empty()) return;
  SurfaceEntry& surface = any_of(d.surfaces, random);
  if (below(3, random) == 0) {  // another rule, with the same counts
    surface.position_scale = std::array<std::uint32_t, 3>{2, 4, 256}[below(3, random)];
    return;
  }
  mutate_any(random, surface.vertices, surface.triangles, surface.position_scale, surface.bytes);
}

void mutate_scenes(Directory& d, Random& random) {
  if (d.scenes.empty() || below(4, random) == 0) d.scenes.push_back({"scene", "", "*", 0, 0, 1});
  Scene& scene = any_of(d.scenes, random);
  switch (below(7, random)) {
    case 0: mutate_text(scene.selection, random); break;
    case 3: mutate_text(scene.cuts, random); break;
    case 4: mutate_text(scene.center, random); break;
    case 5: mutate_text(scene.labels.emplace_back("*"), random); break;
    case 1: mutate_text(scene.caption, random); break;
    case 2: mutate_number(scene.zoom, random); break;
    default: mutate_number(scene.azimuth_deg, random); break;
  }
}

void mutate_sections(Directory& d, Random& random) {
  if (d.sections.empty()) return;
  SectionEntry& section = any_of(d.sections, random);
  if (below(5, random) == 0) return std::swap(section, any_of(d.sections, random));
  mutate_any(random, section.kind, section.chunks, section.chunk_bytes, section.shared_bytes);
}

void mutate_chunk(Directory& d, Random& random) {
  if (d.chunks.empty()) return;
  ChunkEntry& chunk = any_of(d.chunks, random);
  if (below(4, random) == 0) {
    chunk.codec = static_cast<ChunkCodec>(below(4, random));
  } else {
    mutate_any(random, chunk.stored_bytes, chunk.checksum, chunk.filter);
  }
}

void mutate_once(Directory& d, Random& random) {
  switch (below(12, random)) {
    case 0: return mutate_grid(d, random);
    case 1: return mutate_display(d.display, random);
    case 2: return mutate_type(below(2, random) == 0 ? d.value_type : d.label_type, random);
    case 3: return mutate_structures(d, random);
    case 4:
    case 5: return mutate_classes(d, random);
    case 6:
    case 7: return mutate_lengths(d, random);
    case 8: return mutate_surface(d, random);
    case 9: return mutate_scenes(d, random);
    case 10: return mutate_sections(d, random);
    default: return mutate_chunk(d, random);
  }
}

}  // namespace

void mutate_directory(Directory& directory, Random& random) {
  for (std::size_t n = 1 + below(3, random); n > 0; --n) mutate_once(directory, random);
}

}  // namespace splatlas
