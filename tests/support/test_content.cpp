#include "tests/support/test_content.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "format/atlas_writer.h"
#include "format/derive/fit_surface.h"
#include "tests/support/fill_classes.h"
#include "tests/support/marching_tetrahedra.h"

namespace splatlas {
namespace {

/// A mask in storage order; empty for groups.
std::vector<bool> stored_mask(const std::vector<bool>& mask, const Grid& source, const AxisOrder& order) {
  if (mask.empty()) return std::vector<bool>(static_cast<std::size_t>(source.voxels()), false);
  const std::vector<std::uint8_t> from(mask.begin(), mask.end());
  std::vector<std::uint8_t> to(from.size());
  reorder_voxels(from.data(), source.size, order, 1, to.data());
  return {to.begin(), to.end()};
}

/// The storage-grid voxel that contains a triangle of an external surface.
Index3 crossed_voxel(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& corners) {
  Index3 voxel{};
  for (std::size_t a = 0; a < 3; ++a) {
    double sum = 0;
    for (const std::uint32_t corner : corners) sum += static_cast<double>(mesh.positions_ijk[corner][a]);
    voxel[a] = std::llround(sum / 3);
  }
  return voxel;
}

/// Triangles sorted by the memory order of their voxels, as in files.
SurfaceMesh sorted_by_voxel(SurfaceMesh mesh, const Grid& grid) {
  const auto offset = [&](const std::array<std::uint32_t, 3>& corners) {
    const Index3 voxel = crossed_voxel(mesh, corners);
    return grid.offset(voxel[0], voxel[1], voxel[2]);
  };
  std::stable_sort(mesh.triangles.begin(), mesh.triangles.end(),
                   [&](const auto& a, const auto& b) { return offset(a) < offset(b); });
  return mesh;
}

class Classifier {
 public:
  /// `external`: one per structure; empty ones are derived.
  Classifier(const Grid& grid, std::vector<std::vector<bool>> masks, const std::vector<SurfaceMesh>& external)
      : grid_(grid), masks_(std::move(masks)), crossed_(masks_.size()) {
    for (std::size_t s = 0; s < crossed_.size(); ++s) {
      if (external[s].empty()) continue;
      crossed_[s].resize(static_cast<std::size_t>(grid.voxels()));
      for (const auto& corners : external[s].triangles) {
        const Index3 voxel = crossed_voxel(external[s], corners);
        crossed_[s][static_cast<std::size_t>(grid.offset(voxel[0], voxel[1], voxel[2]))] = true;
      }
    }
  }

  void fill(AtlasContent& content) const {
    fill_classes(content, [&](const Index3& at) { return members_of(at); });
    const std::vector<StructureIndex> owners = normal_owners(content.classes);
    content.boundary_normals.resize(owners.size());
    auto c = content.class_volume.begin();
    for_each_voxel(grid_.size, [&](const Index3& at) {
      if (owners[*c] != kNoStructure) content.boundary_normals[*c].push_back(normal(masks_[owners[*c]], at));
      ++c;
    });
  }

 private:
  [[nodiscard]] std::vector<Membership> members_of(const Index3& at) const {
    const auto voxel = static_cast<std::size_t>(grid_.offset(at[0], at[1], at[2]));
    std::vector<Membership> members;
    for (StructureIndex s = 0; s < masks_.size(); ++s) {
      if (!crossed_[s].empty() && crossed_[s][voxel]) members.push_back({s, Part::kCrossed});
      const auto holds = holds_in(masks_[s], grid_.size);
      if (holds(at)) members.push_back({s, is_boundary(at, holds) ? Part::kBoundary : Part::kInterior});
    }
    return members;
  }

  /// Direction in which the mask falls off, LPS.
  [[nodiscard]] PackedNormal normal(const std::vector<bool>& mask, const Index3& at) const {
    Vec3 fall{0, 0, 0};  // per voxel: a covector
    for (std::int64_t n = 0; n < 27; ++n) {
      const Index3 step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
      if (holds_in(mask, grid_.size)({at[0] + step[0], at[1] + step[1], at[2] + step[2]})) continue;
      for (std::size_t a = 0; a < 3; ++a) fall[a] += static_cast<double>(step[a]);
    }
    const Matrix3 to_index = lps_mm_to_index(grid_).linear;
    std::array<float, 3> lps{};
    for (std::size_t a = 0; a < 3; ++a) {
      lps[a] =
          static_cast<float>(fall[0] * to_index[a] + fall[1] * to_index[3 + a] + fall[2] * to_index[6 + a]);
    }
    return pack_normal(lps);
  }

  const Grid& grid_;
  std::vector<std::vector<bool>> masks_;
  std::vector<std::vector<bool>> crossed_;  // empty if there are none
};

/// Bounding ball of all structures; of the grid if there are none.
void frame(const std::vector<std::vector<bool>>& masks, const Grid& grid, Display& display) {
  IndexBox box;
  for (const auto& mask : masks) {
    const auto holds = holds_in(mask, grid.size);
    for_each_voxel(grid.size, [&](const Index3& at) {
      if (holds(at)) box.include({at, at});
    });
  }
  if (box.empty()) box = {{0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1}};
  const Affine to_lps = index_to_lps_mm(grid);
  Vec3 middle{};
  Vec3 half{};
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a] = 0.5 * static_cast<double>(box.first[a] + box.last[a]);
    half[a] = 0.5 * static_cast<double>(box.last[a] - box.first[a] + 1);
  }
  display.center_lps_mm = to_lps.apply(middle);
  display.radius_mm = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3 to_corner =
        to_lps.apply_linear({(corner & 1u) != 0 ? half[0] : -half[0], (corner & 2u) != 0 ? half[1] : -half[1],
                             (corner & 4u) != 0 ? half[2] : -half[2]});
    display.radius_mm =
        std::max(display.radius_mm, std::hypot(std::hypot(to_corner[0], to_corner[1]), to_corner[2]));
  }
}

}  // namespace

AtlasContent make_content(const TestVolume& volume) {
  AtlasContent content;
  content.source_grid = volume.grid;
  content.source_to_storage = storage_order(volume.grid);
  const Grid grid = storage_grid(content);

  std::vector<Structure> structures;
  std::vector<std::vector<bool>> masks;
  std::vector<SurfaceMesh> external;
  for (const TestStructure& s : volume.structures) {
    structures.push_back({s.id, s.id, s.color, std::nullopt, s.parents, !s.external.empty()});
    masks.push_back(stored_mask(s.mask, volume.grid, content.source_to_storage));
    external.push_back(sorted_by_voxel(s.external, grid));
    content.surfaces.push_back(external.back().empty() ? marching_tetrahedra(masks.back(), grid)
                                                       : external.back());
  }
  content.graph = value_or_throw(StructureGraph::build(std::move(structures)));
  Classifier(grid, masks, external).fill(content);

  content.values.type = volume.values.type;
  content.values.bytes.resize(volume.values.bytes.size());
  if (!volume.values.empty()) {
    reorder_voxels(volume.values.bytes.data(), volume.grid.size, content.source_to_storage,
                   bytes_of(volume.values.type), content.values.bytes.data());
  }
  content.display.window_low = volume.window_low;
  content.display.window_high = volume.window_high;
  frame(masks, grid, content.display);
  return content;
}

std::shared_ptr<const Atlas> open_in_memory(const AtlasContent& content) {
  return value_or_throw(Atlas::open_bytes(value_or_throw(encode_atlas(content, {.level = 1, .threads = 1}))));
}

Selection selection_of(std::string_view text, const StructureGraph& graph) {
  return value_or_throw(Selection::parse(text, graph));
}

}  // namespace splatlas
