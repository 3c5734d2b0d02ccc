#include "bench/measure/isolated.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Old to new structure indices; kNoStructure for those not drawn.
std::vector<StructureIndex> numbers_of_drawn(const Selection& selection) {
  std::vector<StructureIndex> numbers;
  StructureIndex next = 0;
  for (const StructureDraw& draw : selection.structures)
    numbers.push_back(draw.mode == DrawMode::kOff ? kNoStructure : next++);
  return numbers;
}

Result<StructureGraph> graph_of(const StructureGraph& graph, const std::vector<StructureIndex>& numbers) {
  std::vector<Structure> structures;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    if (numbers[s] == kNoStructure) continue;
    Structure& kept = structures.emplace_back(graph[s]);
    std::vector<StructureIndex> parents;
    for (const StructureIndex parent : kept.parents) {
      if (numbers[parent] != kNoStructure) parents.push_back(numbers[parent]);
    }
    kept.parents = std::move(parents);
  }
  return StructureGraph::build(std::move(structures));
}

std::vector<Membership> kept_members(const ClassTable& classes, ClassId c,
                                     const std::vector<StructureIndex>& numbers) {
  std::vector<Membership> kept;
  for (const Membership& member : classes.members(c)) {
    if (numbers[member.structure] != kNoStructure) kept.push_back({numbers[member.structure], member.part});
  }
  return kept;
}

bool has_boundary(std::span<const Membership> members) {
  return std::any_of(members.begin(), members.end(),
                     [](const Membership& member) { return member.part == Part::kBoundary; });
}

/// Classes in storage order, and the new class of each old one.
struct KeptClasses {
  ClassTable table;
  std::vector<ClassId> of_old;
};

KeptClasses keep_classes(const AtlasContent& content, const StructureGraph& graph,
                         const std::vector<StructureIndex>& numbers) {
  KeptClasses kept;
  for (ClassId c = 0; c < content.classes.size(); ++c) {
    const std::vector<Membership> members = kept_members(content.classes, c, numbers);
    const ClassId now = members.empty() ? kEmptyClass : kept.table.intern(members);
    kept.table.count(now, content.classes.voxels(c), content.classes.box(c));
    kept.of_old.push_back(now);
  }
  const std::vector<ClassId> order = storage_order(kept.table, graph);
  std::vector<ClassId> number(order.size());
  for (ClassId c = 0; c < order.size(); ++c) number[order[c]] = c;
  kept.table = kept.table.renumbered(order);
  for (ClassId& c : kept.of_old) c = number[c];
  return kept;
}

/// Copies classes, normals and grey values voxel by voxel.
void keep_voxels(const AtlasContent& content, const KeptClasses& kept, AtlasContent& out) {
  const std::size_t value_bytes = bytes_of(content.values.type);
  std::vector<std::size_t> next_normal(content.classes.size());
  out.boundary_normals.resize(kept.table.size());
  for (std::size_t n = 0; n < content.class_volume.size(); ++n) {
    const ClassId old = content.class_volume[n];
    const ClassId now = kept.of_old[old];
    out.class_volume.push_back(now);
    if (now == kEmptyClass && value_bytes > 0)
      std::memset(out.values.bytes.data() + n * value_bytes, 0, value_bytes);
    if (!has_boundary(content.classes.members(old))) continue;
    const PackedNormal normal = content.boundary_normals[old][next_normal[old]++];
    if (has_boundary(kept.table.members(now))) out.boundary_normals[now].push_back(normal);
  }
}

}  // namespace

Result<AtlasContent> isolated(const AtlasContent& content, const Selection& selection,
                              Selection& isolated_selection) {
  const std::vector<StructureIndex> numbers = numbers_of_drawn(selection);
  AtlasContent out;
  out.source_grid = content.source_grid;
  out.source_to_storage = content.source_to_storage;
  SPLATLAS_ASSIGN_OR_RETURN(out.graph, graph_of(content.graph, numbers));
  KeptClasses kept = keep_classes(content, out.graph, numbers);
  out.values = content.values;
  out.label_type = content.label_type;
  out.display = content.display;
  out.provenance = content.provenance;
  isolated_selection = selection;
  isolated_selection.structures.clear();
  for (StructureIndex s = 0; s < numbers.size(); ++s) {
    if (numbers[s] == kNoStructure) continue;
    out.surfaces.push_back(content.surfaces[s]);
    isolated_selection.structures.push_back(selection.structures[s]);
  }
  keep_voxels(content, kept, out);
  out.classes = std::move(kept.table);
  return out;
}

}  // namespace splatlas
