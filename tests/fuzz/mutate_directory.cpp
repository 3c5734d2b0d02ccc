#include "tests/fuzz/mutate_directory.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

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
  switch (below(5, random)) {
    case 0: mutate_number(d.source_grid.size[below(3, random)], random); break;
    case 1: mutate_number(d.source_grid.spacing_mm[below(3, random)], random); break;
    case 2: mutate_number(d.source_grid.origin_lps_mm[below(3, random)], random); break;
    case 3: mutate_number(d.source_grid.direction_lps[below(9, random)], random); break;
    default:
      std::swap(d.source_to_storage.from[below(3, random)], d.source_to_storage.from[below(3, random)]);
      d.source_to_storage.flipped[below(3, random)] ^= true;
      break;
  }
}

void mutate_display(Directory& d, Random& random) {
  switch (below(4, random)) {
    case 0: mutate_number(d.display.window_low, random); break;
    case 1: mutate_number(d.display.window_high, random); break;
    case 2: mutate_number(d.display.center_lps_mm[below(3, random)], random); break;
    default: mutate_number(d.display.radius_mm, random); break;
  }
}

void mutate_type(VoxelType& type, Random& random) {
  type = static_cast<VoxelType>(below(10, random));
}

/// Leaves graphs that cannot be built as they are.
void mutate_structures(Directory& d, Random& random) {
  std::vector<Structure> structures(d.graph.structures().begin(), d.graph.structures().end());
  if (structures.empty()) return;
  Structure& s = any_of(structures, random);
  switch (below(5, random)) {
    case 0: s.external = !s.external; break;
    case 1: mutate_text(s.name, random); break;
    case 2: s.id += "x"; break;
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
  switch (below(4, random)) {
    case 0: mutate_number(row.voxels, random); break;
    case 1: mutate_number(row.box.first[below(3, random)], random); break;
    case 2: mutate_number(row.box.last[below(3, random)], random); break;
    default:
      if (row.members.empty() || below(2, random) == 0) {
        if (structures == 0) return;
        row.members.push_back({static_cast<StructureIndex>(below(structures, random)), Part::kBoundary});
      } else if (Membership& member = any_of(row.members, random); below(2, random) == 0) {
        member.part = static_cast<Part>(below(3, random));
      } else {
        member = row.members.back();
        row.members.pop_back();
      }
      break;
  }
}

/// Half of the time the empty class absorbs the difference in voxels, so that the sum stays. Tables that
/// repeat a class stay as they are.
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
  switch (below(3, random)) {
    case 0: mutate_number(any_of(d.run_bytes, random)[below(3, random)], random); break;
    case 1: mutate_number(d.run_totals[below(3, random)], random); break;
    default: d.normals_fitted[below(d.normals_fitted.size(), random)].flip(); break;
  }
}

void mutate_surface(Directory& d, Random& random) {
  if (d.surfaces.empty()) return;
  SurfaceEntry& surface = any_of(d.surfaces, random);
  switch (below(4, random)) {
    case 0: mutate_number(surface.vertices, random); break;
    case 1: mutate_number(surface.triangles, random); break;
    case 2: mutate_number(surface.position_scale, random); break;
    default: mutate_number(surface.bytes, random); break;
  }
}

void mutate_scenes(Directory& d, Random& random) {
  if (d.scenes.empty() || below(4, random) == 0) d.scenes.push_back({"scene", "", "*", 0, 0, 1});
  Scene& scene = any_of(d.scenes, random);
  switch (below(4, random)) {
    case 0: mutate_text(scene.selection, random); break;
    case 1: mutate_text(scene.caption, random); break;
    case 2: mutate_number(scene.zoom, random); break;
    default: mutate_number(scene.azimuth_deg, random); break;
  }
}

void mutate_sections(Directory& d, Random& random) {
  if (d.sections.empty()) return;
  SectionEntry& section = any_of(d.sections, random);
  switch (below(5, random)) {
    case 0: mutate_number(section.kind, random); break;
    case 1: mutate_number(section.chunks, random); break;
    case 2: mutate_number(section.chunk_bytes, random); break;
    case 3: mutate_number(section.shared_bytes, random); break;
    default: std::swap(section, any_of(d.sections, random)); break;
  }
}

void mutate_chunk(Directory& d, Random& random) {
  if (d.chunks.empty()) return;
  ChunkEntry& chunk = any_of(d.chunks, random);
  switch (below(4, random)) {
    case 0: mutate_number(chunk.stored_bytes, random); break;
    case 1: mutate_number(chunk.checksum, random); break;
    case 2: chunk.codec = static_cast<ChunkCodec>(below(4, random)); break;
    default: mutate_number(chunk.filter, random); break;
  }
}

void mutate_once(Directory& d, Random& random) {
  switch (below(12, random)) {
    case 0: return mutate_grid(d, random);
    case 1: return mutate_display(d, random);
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
