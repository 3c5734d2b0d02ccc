#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/format/golden/golden_contents.h"

namespace splatlas {
namespace {

using Out = std::back_insert_iterator<std::string>;

void tell_grid(const AtlasContent& content, Out out) {
  const Grid& grid = content.source_grid;
  fmt::format_to(out, "size {}\nspacing_mm {}\norigin_lps_mm {}\ndirection_lps {}\n",
                 fmt::join(grid.size, " "), fmt::join(grid.spacing_mm, " "),
                 fmt::join(grid.origin_lps_mm, " "), fmt::join(grid.direction_lps, " "));
  for (std::size_t a = 0; a < 3; ++a) {
    fmt::format_to(out, "storage axis {} is source axis {}{}\n", a, content.source_to_storage.from[a],
                   content.source_to_storage.flipped[a] ? " reversed" : "");
  }
  const Display& display = content.display;
  fmt::format_to(out, "window {} {}\nball {} radius {}\n", display.window_low, display.window_high,
                 fmt::join(display.center_lps_mm, " "), display.radius_mm);
}

void tell_texts(const AtlasContent& content, Out out) {
  const Provenance& p = content.provenance;
  fmt::format_to(out, "title {:?}\ncitation {:?}\nlicence {:?}\ntool {:?}\n", p.title, p.citation, p.licence,
                 p.tool);
  for (const Source& source : p.sources) fmt::format_to(out, "source {:?} {:?}\n", source.role, source.hash);
  for (const Scene& scene : content.scenes) {
    fmt::format_to(out, "scene {:?} {:?} {:?} azimuth {} elevation {} zoom {}\n", scene.name, scene.caption,
                   scene.selection, scene.azimuth_deg, scene.elevation_deg, scene.zoom);
    const bool has_more = !(scene.question + scene.cuts + scene.center).empty();
    if (has_more)
      fmt::format_to(out, "  {:?} cuts {:?} center {:?}\n", scene.question, scene.cuts, scene.center);
    if (scene.perspective || !scene.labels.empty())
      fmt::format_to(out, "  perspective {} labels {}\n", scene.perspective, fmt::join(scene.labels, " "));
  }
}

void tell_structures(const AtlasContent& content, Out out) {
  for (const Structure& s : content.graph.structures()) {
    fmt::format_to(out, "structure {:?} {:?} color {} {} {} label {} parents [{}]{}\n", s.id, s.name,
                   s.color.r, s.color.g, s.color.b, s.label ? std::to_string(*s.label) : "none",
                   fmt::join(s.parents, " "), s.external ? " external" : "");
    for (const Term& term : s.terms) fmt::format_to(out, "term {:?} {:?}\n", term.vocabulary, term.value);
  }
}

void tell_classes(const AtlasContent& content, Out out) {
  for (ClassId c = 0; c < content.classes.size(); ++c) {
    fmt::format_to(out, "class {}: {} voxels, members", c, content.classes.voxels(c));
    for (const Membership& m : content.classes.members(c)) {
      fmt::format_to(out, " {}.{}", m.structure, static_cast<int>(m.part));
    }
    fmt::format_to(out, "\n  normals {:04x}\n", fmt::join(content.boundary_normals[c], " "));
  }
}

/// One line per row, for any voxel size.
template <typename Voxel>
void tell_rows(const AtlasContent& content, Out out, const Voxel& voxel) {
  const Index3 size = storage_grid(content).size;
  for (std::size_t v = 0; v < content.class_volume.size(); ++v) {
    voxel(v);
    *out = (v + 1) % static_cast<std::size_t>(size[0]) == 0 ? '\n' : ' ';
  }
}

void tell_voxels(const AtlasContent& content, Out out) {
  fmt::format_to(out, "classes of voxels\n");
  tell_rows(content, out, [&](std::size_t v) { fmt::format_to(out, "{}", content.class_volume[v]); });
  fmt::format_to(out, "labels {}\nvalues {}\n", name_of(content.label_type), name_of(content.values.type));
  if (content.values.empty()) return;
  const std::size_t bytes = bytes_of(content.values.type);
  tell_rows(content, out, [&](std::size_t v) {
    for (std::size_t n = bytes; n-- > 0;) {
      fmt::format_to(out, "{:02x}", std::to_integer<unsigned>(content.values.bytes[v * bytes + n]));
    }
  });
}

void tell_surfaces(const AtlasContent& content, Out out) {
  for (StructureIndex s = 0; s < content.surfaces.size(); ++s) {
    const SurfaceMesh& mesh = content.surfaces[s];
    if (mesh.empty()) continue;
    fmt::format_to(out, "surface of {} in 1/{}\n", content.graph[s].id, mesh.position_scale);
    for (std::size_t v = 0; v < mesh.positions_ijk.size(); ++v) {
      fmt::format_to(out, "  {} {:04x}\n", fmt::join(mesh.positions_ijk[v], " "),
                     pack_normal(mesh.normals_lps[v]));
    }
    for (const auto& triangle : mesh.triangles) fmt::format_to(out, "  {}\n", fmt::join(triangle, " "));
  }
}

/// The labels and values of a text, or all of a text that has nothing else.
std::string values_in(const std::string& text) {
  const std::size_t first = text.starts_with("labels ") ? 0 : text.find("\nlabels ") + 1;
  return text.substr(first, text.find("surface of ", first) - first);
}

}  // namespace

std::string with_values_of(std::string text, const std::string& other) {
  const std::string values = values_in(text);
  return text.replace(text.find(values), values.size(), values_in(other));
}

std::string text_beside(const std::string& good, const std::string& text) {
  return with_values_of(text, good) == good ? values_in(text) : text;
}

std::string content_text(const AtlasContent& content) {
  std::string text;
  const Out out(text);
  tell_grid(content, out);
  tell_texts(content, out);
  tell_structures(content, out);
  tell_classes(content, out);
  tell_voxels(content, out);
  tell_surfaces(content, out);
  return text;
}

}  // namespace splatlas
