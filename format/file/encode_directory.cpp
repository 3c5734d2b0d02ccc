#include <fmt/format.h>

#include "format/file/directory.h"
#include "format/file/file_layout.h"
#include "format/file/schema_arrays.h"
#include "format/result_macros.h"
#include "schemas/atlas_generated.h"

namespace splatlas {
namespace {

TextWriter write_text(const Directory& directory) {
  TextWriter text;
  const Provenance& provenance = directory.provenance;
  text.add({provenance.title, provenance.citation, provenance.licence, provenance.tool});
  for (const Structure& structure : directory.graph.structures()) text.add({structure.id, structure.name});
  for (const Scene& scene : directory.scenes) text.add({scene.name, scene.caption, scene.selection});
  for (const Source& source : provenance.sources) text.add({source.role, source.hash});
  return text;
}

struct StructureTable {
  std::vector<schema::Structure> structures;
  std::vector<std::uint32_t> parents;
  std::vector<std::uint32_t> terms_end;
  TextWriter term_text;
};

StructureTable write_structures(const StructureGraph& graph) {
  StructureTable table;
  for (const Structure& s : graph.structures()) {
    table.parents.insert(table.parents.end(), s.parents.begin(), s.parents.end());
    const std::array<std::uint8_t, 3> rgb{s.color.r, s.color.g, s.color.b};
    const int flags = (s.label ? kFlagLabel : 0) | (s.external ? kFlagExternal : 0);
    table.structures.emplace_back(s.label.value_or(0), static_cast<std::uint32_t>(table.parents.size()), rgb,
                                  static_cast<std::uint8_t>(flags));
    for (const Term& term : s.terms) table.term_text.add({term.vocabulary, term.value});
    table.terms_end.push_back(static_cast<std::uint32_t>(table.term_text.ends().size() / 2));
  }
  return table;
}

struct ClassRows {
  std::vector<schema::Class> classes;
  std::vector<std::uint32_t> members;
};

ClassRows write_classes(const Directory& directory) {
  ClassRows rows;
  for (ClassId c = 0; c < directory.classes.size(); ++c) {
    for (const Membership& member : directory.classes.members(c)) {
      rows.members.push_back(member.structure * 4 + static_cast<std::uint32_t>(member.part));
    }
    const IndexBox& box = directory.classes.box(c);
    const auto first = to_array<3, std::int32_t>(box.first), last = to_array<3, std::int32_t>(box.last);
    rows.classes.emplace_back(directory.classes.voxels(c), first, last, directory.run_bytes[c],
                              static_cast<std::uint32_t>(rows.members.size()));
  }
  return rows;
}

template <typename Row, typename Entry, typename Convert>
std::vector<Row> convert_rows(const std::vector<Entry>& entries, Convert&& convert) {
  std::vector<Row> rows;
  rows.reserve(entries.size());
  for (const Entry& entry : entries) rows.push_back(convert(entry));
  return rows;
}

}  // namespace

Result<std::vector<std::byte>> encode_directory(const Directory& directory) {
  const Grid& grid = directory.source_grid;
  const schema::Grid grid_row(grid.spacing_mm, grid.origin_lps_mm, grid.direction_lps, grid.size);
  const auto flipped = to_array<3, std::uint8_t>(directory.source_to_storage.flipped);
  const schema::AxisOrder order_row(directory.source_to_storage.from, flipped);
  const Display& display = directory.display;
  const schema::Display display_row(display.window_low, display.window_high, display.center_lps_mm,
                                    display.radius_mm);
  const schema::RunTotals totals_row(directory.run_totals);
  const TextWriter text = write_text(directory);
  const StructureTable structures = write_structures(directory.graph);
  const ClassRows classes = write_classes(directory);
  const auto surfaces = convert_rows<schema::Surface>(directory.surfaces, [](const SurfaceEntry& s) {
    return schema::Surface(s.vertices, s.triangles, s.position_scale, s.bytes);
  });
  const auto scenes = convert_rows<schema::Scene>(
      directory.scenes, [](const Scene& s) { return schema::Scene(s.azimuth_deg, s.elevation_deg, s.zoom); });
  const auto sections = convert_rows<schema::Section>(directory.sections, [](const SectionEntry& s) {
    return schema::Section(s.kind, s.chunks, s.chunk_bytes, s.shared_bytes);
  });
  const auto chunks = convert_rows<schema::Chunk>(directory.chunks, [](const ChunkEntry& c) {
    return schema::Chunk(c.checksum, c.stored_bytes, static_cast<std::uint8_t>(c.codec), c.filter, 0);
  });

  TextWriter scene_text, scene_views;
  for (const Scene& s : directory.scenes) {
    scene_text.add({s.question, s.cuts, s.center});
    scene_views.add({s.perspective ? kPerspective : "", fmt::format("{}", fmt::join(s.labels, "\n"))});
  }
  const bool has_scene_text = !scene_text.bytes().empty();
  const bool has_scene_views = !scene_views.bytes().empty();
  const bool has_terms = !structures.term_text.ends().empty();
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(
      schema::CreateDirectory(
          builder, &grid_row, &order_row, static_cast<std::uint8_t>(directory.value_type),
          static_cast<std::uint8_t>(directory.label_type), &display_row, &totals_row,
          builder.CreateVectorOfStructs(structures.structures), builder.CreateVector(structures.parents),
          builder.CreateVectorOfStructs(surfaces), builder.CreateVectorOfStructs(classes.classes),
          builder.CreateVector(classes.members), builder.CreateVectorOfStructs(scenes),
          static_cast<std::uint32_t>(directory.provenance.sources.size()), builder.CreateVector(text.ends()),
          builder.CreateVector(text.bytes()), builder.CreateVectorOfStructs(sections),
          builder.CreateVectorOfStructs(chunks),
          builder.CreateVector(
              std::vector<std::uint8_t>(directory.normals_fitted.begin(), directory.normals_fitted.end())),
          builder.CreateVector(directory.fingerprints),
          has_terms ? builder.CreateVector(structures.terms_end) : 0,
          has_terms ? builder.CreateVector(structures.term_text.ends()) : 0,
          has_terms ? builder.CreateVector(structures.term_text.bytes()) : 0,
          has_scene_text ? builder.CreateVector(scene_text.ends()) : 0,
          has_scene_text ? builder.CreateVector(scene_text.bytes()) : 0,
          directory.mean_blocks.empty() ? 0 : builder.CreateVector(directory.mean_blocks),
          has_scene_views ? builder.CreateVector(scene_views.ends()) : 0,
          has_scene_views ? builder.CreateVector(scene_views.bytes()) : 0),
      schema::DirectoryIdentifier());
  if (builder.GetSize() > kMaxDirectoryBytes) {
    return fail(ErrorCode::kFailed, "the directory takes {} bytes (limit {})", builder.GetSize(),
                kMaxDirectoryBytes);
  }
  const auto* begin = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  return std::vector<std::byte>(begin, begin + builder.GetSize());
}

}  // namespace splatlas
