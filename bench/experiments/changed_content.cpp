#include "bench/experiments/changed_content.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "format/file/directory.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Source of a new voxel along one axis, and whether the new voxel is the original.
struct Origin {
  std::int64_t voxel = 0;
  bool own = true;
};
using Origins = std::array<std::vector<Origin>, 3>;

/// The structures, followed by as many copies.
Result<StructureGraph> with_copies(const StructureGraph& graph) {
  std::vector<Structure> structures(graph.structures().begin(), graph.structures().end());
  const auto count = static_cast<StructureIndex>(graph.size());
  for (StructureIndex s = 0; s < count; ++s) {
    Structure copy = structures[s];
    copy.id = "around_" + copy.id;
    copy.name = "Around " + copy.name;
    copy.label.reset();
    for (StructureIndex& parent : copy.parents) parent += count;
    structures.push_back(std::move(copy));
  }
  return StructureGraph::build(std::move(structures));
}

/// Numbers the classes in storage order. Voxels hold indices into `members`, of which some may be equal.
void number_classes(const std::vector<std::vector<Membership>>& members, AtlasContent& content) {
  std::vector<std::uint64_t> counts(members.size(), 0);
  std::vector<IndexBox> boxes(members.size());
  const Index3 size = storage_grid(content).size;
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i, ++voxel) {
        ++counts[content.class_volume[voxel]];
        boxes[content.class_volume[voxel]].include({{i, j, k}, {i, j, k}});
      }
    }
  }
  ClassTable table;
  std::vector<ClassId> interned(members.size(), kEmptyClass);
  for (std::size_t c = 0; c < members.size(); ++c) {
    if (counts[c] == 0) continue;
    interned[c] = table.intern(members[c]);
    table.count(interned[c], counts[c], boxes[c]);
  }
  const std::vector<ClassId> order = storage_order(table, content.graph);
  std::vector<ClassId> number(order.size());
  for (ClassId c = 0; c < order.size(); ++c) number[order[c]] = c;
  for (ClassId& c : content.class_volume) c = number[interned[c]];
  content.classes = table.renumbered(order);
}

/// Fills in everything that depends on voxels. Copies have structures of their own.
void grow(const AtlasContent& from, const Origins& origins, AtlasContent& to) {
  const auto classes = static_cast<ClassId>(from.classes.size());
  const Grid from_grid = storage_grid(from);
  const std::size_t bytes = bytes_of(from.values.type);
  for (const Origin& slice : origins[2]) {
    for (const Origin& row : origins[1]) {
      const std::int64_t first = from_grid.offset(0, row.voxel, slice.voxel);
      for (const Origin& column : origins[0]) {
        const auto voxel = static_cast<std::size_t>(first + column.voxel);
        const ClassId c = from.class_volume[voxel];
        const bool own = slice.own && row.own && column.own;
        to.class_volume.push_back(own || c == kEmptyClass ? c : c + classes);
        const std::byte* const value = from.values.bytes.data() + voxel * bytes;
        to.values.bytes.insert(to.values.bytes.end(), value, value + bytes);
      }
    }
  }
  std::vector<std::vector<Membership>> members;
  for (const std::size_t shift : {std::size_t{0}, from.graph.size()}) {
    for (ClassId c = 0; c < classes; ++c) {
      const auto source = from.classes.members(c);
      members.emplace_back(source.begin(), source.end());
      for (Membership& member : members.back()) member.structure += static_cast<StructureIndex>(shift);
    }
  }
  number_classes(members, to);
  to.values.type = from.values.type;
  to.label_type = from.label_type;
  to.surfaces.resize(to.graph.size());
  to.display = from.display;
  to.provenance = from.provenance;
  for (ClassId c = 0; c < to.classes.size(); ++c) {
    to.boundary_normals.emplace_back(has_normals(to.classes, c) ? to.classes.voxels(c) : 0,
                                     pack_normal({0, 0, 1}));
  }
}

}  // namespace

Result<AtlasContent> surrounded(const AtlasContent& content, const Index3& times) {
  Grid grid = storage_grid(content);
  Origins origins;
  Vec3 first{};  // origin of the new grid, in old voxels
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t n = grid.size[a];
    const std::int64_t before = n * (times[a] - 1) / 2;
    for (std::int64_t i = -before; i < n * times[a] - before; ++i) {
      const std::int64_t in_pair = ((i % (2 * n)) + 2 * n) % (2 * n);  // every other copy is mirrored
      origins[a].push_back({std::min(in_pair, 2 * n - 1 - in_pair), i >= 0 && i < n});
    }
    grid.size[a] = n * times[a];
    first[a] = -static_cast<double>(before);
  }
  grid.origin_lps_mm = index_to_lps_mm(grid).apply(first);
  AtlasContent grown;
  grown.source_grid = grid;
  SPLATLAS_ASSIGN_OR_RETURN(grown.graph, with_copies(content.graph));
  grow(content, origins, grown);
  return grown;
}

AtlasContent refined(const AtlasContent& content, const Index3& size) {
  Grid grid = storage_grid(content);
  Origins origins;
  Vec3 first{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t n = grid.size[a];
    const double step = static_cast<double>(n) / static_cast<double>(size[a]);
    for (std::int64_t i = 0; i < size[a]; ++i) origins[a].push_back({(2 * i + 1) * n / (2 * size[a]), true});
    first[a] = 0.5 * step - 0.5;
  }
  grid.origin_lps_mm = index_to_lps_mm(grid).apply(first);
  for (std::size_t a = 0; a < 3; ++a) {
    grid.spacing_mm[a] *= static_cast<double>(grid.size[a]) / static_cast<double>(size[a]);
  }
  grid.size = size;
  AtlasContent grown;
  grown.source_grid = grid;
  grown.graph = content.graph;
  grow(content, origins, grown);
  return grown;
}

AtlasContent isolated(const AtlasContent& content, const Selection& selection) {
  AtlasContent alone = content;
  alone.fitted.clear();
  alone.scenes.clear();
  const auto is_drawn = [&](StructureIndex s) { return selection.structures[s].mode != DrawMode::kOff; };
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    if (!is_drawn(s)) alone.surfaces[s] = {};
  }
  std::vector<std::vector<Membership>> members(content.classes.size());
  for (ClassId c = 0; c < members.size(); ++c) {
    for (const Membership& member : content.classes.members(c)) {
      if (is_drawn(member.structure)) members[c].push_back(member);
    }
  }
  number_classes(members, alone);
  alone.boundary_normals.assign(alone.classes.size(), {});
  const std::size_t bytes = bytes_of(content.values.type);
  std::vector<std::size_t> next_normal(content.classes.size(), 0);
  for (std::size_t n = 0; n < content.class_volume.size(); ++n) {
    const ClassId old = content.class_volume[n], now = alone.class_volume[n];
    if (now == kEmptyClass) std::fill_n(&alone.values.bytes[n * bytes], bytes, std::byte{0});
    if (!has_normals(content.classes, old)) continue;
    const PackedNormal normal = content.boundary_normals[old][next_normal[old]++];
    if (has_normals(alone.classes, now)) alone.boundary_normals[now].push_back(normal);
  }
  return alone;
}

}  // namespace splatlas
