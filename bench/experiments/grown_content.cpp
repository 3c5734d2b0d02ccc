#include "bench/experiments/grown_content.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
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

/// Fills in everything that depends on voxels.
class Growth {
 public:
  Growth(const AtlasContent& from, const Origins& origins) : from_(from), origins_(origins) {}

  void fill(AtlasContent& to) {
    copy_voxels(to);
    number_classes(to);
    to.values.type = from_.values.type;
    to.label_type = from_.label_type;
    to.surfaces.resize(to.graph.size());
    to.display = from_.display;
    to.provenance = from_.provenance;
    const PackedNormal up = pack_normal({0, 0, 1});
    for (ClassId c = 0; c < to.classes.size(); ++c) {
      to.boundary_normals.emplace_back(has_normals(to.classes, c) ? to.classes.voxels(c) : 0, up);
    }
  }

 private:
  /// Copies values and classes, still numbered as in the source with copies after them, and counts them.
  void copy_voxels(AtlasContent& to) {
    const auto classes = static_cast<ClassId>(from_.classes.size());
    const Index3 size{std::ssize(origins_[0]), std::ssize(origins_[1]), std::ssize(origins_[2])};
    const Grid from_grid = storage_grid(from_);
    const std::size_t bytes = bytes_of(from_.values.type);
    const auto voxels = static_cast<std::size_t>(size[0] * size[1] * size[2]);
    to.class_volume.resize(voxels);
    to.values.bytes.resize(voxels * bytes);
    counts_.assign(2 * from_.classes.size(), 0);
    boxes_.assign(2 * from_.classes.size(), {});
    std::size_t next = 0;
    for (std::int64_t k = 0; k < size[2]; ++k) {
      for (std::int64_t j = 0; j < size[1]; ++j) {
        const Origin& slice = origins_[2][static_cast<std::size_t>(k)];
        const Origin& row = origins_[1][static_cast<std::size_t>(j)];
        const std::int64_t first = from_grid.offset(0, row.voxel, slice.voxel);
        for (std::int64_t i = 0; i < size[0]; ++i, ++next) {
          const Origin& column = origins_[0][static_cast<std::size_t>(i)];
          const auto voxel = static_cast<std::size_t>(first + column.voxel);
          const bool own = slice.own && row.own && column.own;
          const ClassId c = from_.class_volume[voxel];
          const ClassId number = own || c == kEmptyClass ? c : c + classes;
          to.class_volume[next] = number;
          ++counts_[number];
          boxes_[number].include(Index3{i, j, k});
          if (bytes > 0)
            std::memcpy(&to.values.bytes[next * bytes], &from_.values.bytes[voxel * bytes], bytes);
        }
      }
    }
  }

  /// Numbers classes with voxels in storage order.
  void number_classes(AtlasContent& to) const {
    const auto classes = static_cast<ClassId>(from_.classes.size());
    ClassTable table;
    std::vector<ClassId> interned(counts_.size(), kEmptyClass);
    for (ClassId c = 0; c < counts_.size(); ++c) {
      if (counts_[c] == 0) continue;
      const auto source = from_.classes.members(c % classes);
      std::vector<Membership> members(source.begin(), source.end());
      const auto shift = static_cast<StructureIndex>(c < classes ? 0 : from_.graph.size());
      for (Membership& member : members) member.structure += shift;
      interned[c] = table.intern(std::move(members));
      table.count(interned[c], counts_[c], boxes_[c]);
    }
    const std::vector<ClassId> order = storage_order(table, to.graph);
    std::vector<ClassId> number(order.size());
    for (ClassId c = 0; c < order.size(); ++c) number[order[c]] = c;
    for (ClassId& c : interned) c = number[c];
    for (ClassId& c : to.class_volume) c = interned[c];
    to.classes = table.renumbered(order);
  }

  const AtlasContent& from_;
  const Origins& origins_;
  std::vector<std::uint64_t> counts_;  // per source class, then per copy
  std::vector<IndexBox> boxes_;
};

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
  Growth(content, origins).fill(grown);
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
  Growth(content, origins).fill(grown);
  return grown;
}

}  // namespace splatlas
