#include "preprocess/structures/build_graph.h"

#include <algorithm>

#include "format/result_macros.h"
#include "preprocess/import/import_error.h"
#include "preprocess/structures/place_nodes.h"
#include "preprocess/structures/place_paths.h"

namespace splatlas {
namespace {

/// Graph of the sources without parents, for lookups by name and pattern.
Result<StructureGraph> graph_of_sources(std::span<const SourceStructure> sources, UniqueIds& ids) {
  std::vector<Structure> structures;
  for (const SourceStructure& source : sources) {
    Structure structure;
    structure.id = ids.claim(source.name);
    structure.name = source.name;
    structure.color = source.color.value_or(default_color(structures.size()));
    structure.label = source.label;
    structure.external = source.external;
    structure.terms = source.terms;
    structures.push_back(std::move(structure));
  }
  return StructureGraph::build(std::move(structures));
}

}  // namespace

Result<PlacedStructures> build_graph(std::span<const SourceStructure> sources,
                                     std::span<const TreeLine> lines, const std::string& file, Notes& notes) {
  UniqueIds ids;
  SPLATLAS_ASSIGN_OR_RETURN(StructureGraph flat, graph_of_sources(sources, ids));
  const SourceLookup lookup(sources, std::move(flat));
  GraphParts parts(lookup.flat(), ids);
  std::vector<TreeLine> paths;
  std::vector<TreeLine> nodes;
  for (const TreeLine& line : lines) (line.node ? nodes : paths).push_back(line);
  PathPlacer path_placer(lookup, parts, notes);
  SPLATLAS_RETURN_IF_ERROR(path_placer.place(paths, file));
  SPLATLAS_RETURN_IF_ERROR(place_nodes(nodes, file, lookup, parts, notes));
  auto [structures, index_of_source] = parts.finish();
  Result<StructureGraph> graph = StructureGraph::build(std::move(structures));
  if (!graph) return bad_file(file, "{}", graph.error().message);
  return PlacedStructures{std::move(*graph), std::move(index_of_source)};
}

}  // namespace splatlas
