// Small random atlases of every feature, and their comparison, for property tests.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "format/content/atlas_content.h"
#include "tests/format/random_graph.h"
#include "tests/support/fill_classes.h"

namespace splatlas {

/// Limits of random atlases.
struct ContentLimits {
  std::int64_t max_side = 12;      ///< voxels
  std::size_t max_structures = 8;  ///< may be 0
  std::size_t max_vertices = 60;   ///< per surface
};

/// Builds one random atlas. Structures are overlapping boxes and balls; some are groups, empty, or external
/// with crossed voxels. Several parents are common.
class RandomContent {
 public:
  RandomContent(std::mt19937& random, const ContentLimits& limits) : random_(random), limits_(limits) {}

  AtlasContent make() {
    make_grid();
    make_structures();
    make_classes();
    make_values();
    for (StructureIndex s = 0; s < content_.graph.size(); ++s) content_.surfaces.push_back(make_surface());
    make_texts();
    return std::move(content_);
  }

 private:
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::string text(const char* what) {
    static const std::array<const char*, 5> kTexts{"", "a", "Größe\n1\t2", "脳の地図", "x = \"1\" + (y)"};
    return below(3) == 0 ? what : kTexts[below(kTexts.size())];
  }

  void make_grid() {
    Grid& grid = content_.source_grid;
    for (auto& n : grid.size) {
      n = 1 + static_cast<std::int64_t>(below(static_cast<std::size_t>(limits_.max_side)));
    }
    for (double& mm : grid.spacing_mm) mm = real(0.1, 4);
    for (double& mm : grid.origin_lps_mm) mm = real(-200, 200);
    std::array<std::size_t, 3> axes{0, 1, 2};
    std::shuffle(axes.begin(), axes.end(), random_);
    grid.direction_lps = {};
    for (std::size_t a = 0; a < 3; ++a) {  // a signed permutation, slightly sheared
      for (std::size_t row = 0; row < 3; ++row) grid.direction_lps[3 * row + a] = real(-0.1, 0.1);
      grid.direction_lps[3 * axes[a] + a] = below(2) == 0 ? 1 : -1;
    }
    content_.source_to_storage = storage_order(grid);
    size_ = storage_grid(content_).size;
  }

  void make_structures() {
    const StructureGraph bare = random_graph(below(limits_.max_structures + 1), random_);
    std::vector<Structure> structures(bare.structures().begin(), bare.structures().end());
    for (Structure& s : structures) {
      if (below(2) == 0) s.label = static_cast<std::int64_t>(random_()) - 0x7fffffff;
    }
    content_.graph = *StructureGraph::build(std::move(structures));
  }

  /// The voxels of one structure: none, a ball or a box, which may exceed the grid.
  std::vector<bool> make_mask() {
    const std::size_t kind = below(4);  // 0: empty
    std::array<double, 3> center{}, radius{};
    for (std::size_t a = 0; a < 3; ++a) {
      center[a] = real(0, static_cast<double>(size_[a]));
      radius[a] = real(0.5, static_cast<double>(size_[a]));
    }
    std::vector<bool> mask;
    for_each_voxel(size_, [&](const Index3& at) {
      double squares = 0, largest = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double d = (static_cast<double>(at[a]) - center[a]) / radius[a];
        squares += d * d;
        largest = std::max(largest, std::abs(d));
      }
      mask.push_back(kind != 0 && (kind == 1 ? largest : squares) < 1);
    });
    return mask;
  }

  void make_classes() {
    const StructureGraph& graph = content_.graph;
    std::vector<std::vector<bool>> masks;
    for (StructureIndex s = 0; s < graph.size(); ++s) masks.push_back(make_mask());
    fill_classes(content_, [&](const Index3& at) {
      std::vector<Membership> members;
      for (StructureIndex s = 0; s < graph.size(); ++s) {
        const auto holds = holds_in(masks[s], size_);
        if (!holds(at)) continue;
        const bool boundary = is_boundary(at, holds);
        if (graph[s].external) {
          if (boundary) members.push_back({s, Part::kCrossed});
        } else {
          members.push_back({s, boundary ? Part::kBoundary : Part::kInterior});
        }
      }
      return members;
    });
    for (ClassId c = 0; c < content_.classes.size(); ++c) {
      const auto members = content_.classes.members(c);
      const bool has = std::any_of(members.begin(), members.end(),
                                   [](const Membership& m) { return m.part == Part::kBoundary; });
      auto& normals = content_.boundary_normals.emplace_back(has ? content_.classes.voxels(c) : 0);
      for (PackedNormal& n : normals) n = static_cast<PackedNormal>(random_());
    }
  }

  /// Any bytes, including not-a-number with payloads and runs of equal values.
  void make_values() {
    VoxelBuffer& values = content_.values;
    values.type = static_cast<VoxelType>(below(9));
    const bool flat = below(2) == 0;
    values.bytes.resize(content_.class_volume.size() * bytes_of(values.type));
    for (std::byte& b : values.bytes) b = static_cast<std::byte>(flat && below(8) != 0 ? 0 : random_());
    content_.label_type = static_cast<VoxelType>(below(9));
  }

  SurfaceMesh make_surface() {
    SurfaceMesh mesh;
    mesh.position_scale = std::array<std::uint32_t, 5>{1, 2, 10, 32, 8192}[below(5)];
    const std::size_t vertices = below(3) == 0 ? 0 : below(limits_.max_vertices + 1);
    for (std::size_t v = 0; v < vertices; ++v) {
      std::array<float, 3> position{};
      for (std::size_t a = 0; a < 3; ++a) {
        const auto steps = static_cast<std::size_t>(size_[a] + 1) * mesh.position_scale + 1;
        const double counted = static_cast<double>(below(steps)) - mesh.position_scale;
        position[a] = static_cast<float>(counted / mesh.position_scale);
      }
      mesh.positions_ijk.push_back(position);
      mesh.normals_lps.push_back(unpack_normal(static_cast<PackedNormal>(random_())));
    }
    const bool strip = below(2) == 0;
    for (std::size_t t = 0; vertices != 0 && t < 2 * vertices; ++t) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t n = 0; n < 3; ++n) {
        triangle[n] = static_cast<std::uint32_t>(strip ? (t + n) % vertices : below(vertices));
      }
      mesh.triangles.push_back(triangle);
    }
    return mesh;
  }

  void make_texts() {
    content_.display = {real(-1000, 0), real(0, 1000), {real(-9, 9), real(-9, 9), real(-9, 9)}, real(0, 99)};
    for (std::size_t n = below(3); n > 0; --n) {
      content_.scenes.push_back({text("scene"), text("caption"), text("selection"), real(-360, 360),
                                 real(-90, 90), real(0.01, 100)});
      if (below(2) == 0) content_.scenes.back().labels = {"one", "two three"};
      content_.scenes.back().perspective = below(2) == 0;
    }
    content_.provenance = {text("title"), text("citation"), text("licence"), text("tool"), {}};
    for (std::size_t n = below(3); n > 0; --n)
      content_.provenance.sources.push_back({text("role"), text("hash")});
  }

  std::mt19937& random_;
  const ContentLimits limits_;
  AtlasContent content_;
  Index3 size_{};
};

inline AtlasContent random_content(std::mt19937& random, const ContentLimits& limits = {}) {
  return RandomContent(random, limits).make();
}

inline AtlasContent random_content(std::uint32_t seed, const ContentLimits& limits = {}) {
  std::mt19937 random(seed);
  return random_content(random, limits);
}

/// The first random atlas of this seed that is `wanted(content)`.
template <typename Wanted>
AtlasContent random_content_with(const Wanted& wanted, std::uint32_t seed, const ContentLimits& limits) {
  std::mt19937 random(seed);
  for (;;) {
    AtlasContent content = random_content(random, limits);
    if (wanted(content)) return content;
  }
}

inline bool same_classes(const ClassTable& a, const ClassTable& b) {
  if (a.size() != b.size()) return false;
  for (ClassId c = 0; c < a.size(); ++c) {
    if (a.voxels(c) != b.voxels(c) || a.box(c) != b.box(c) ||
        !std::ranges::equal(a.members(c), b.members(c))) {
      return false;
    }
  }
  return true;
}

/// The first part in which two atlases differ; "" if they are equal. Values are compared bytewise.
inline std::string difference(const AtlasContent& a, const AtlasContent& b) {
  if (a.source_grid != b.source_grid) return "source_grid";
  if (a.source_to_storage != b.source_to_storage) return "source_to_storage";
  if (!std::ranges::equal(a.graph.structures(), b.graph.structures())) return "graph";
  if (!same_classes(a.classes, b.classes)) return "classes";
  if (a.class_volume != b.class_volume) return "class_volume";
  if (a.values != b.values) return "values";
  if (a.label_type != b.label_type) return "label_type";
  if (a.surfaces != b.surfaces) return "surfaces";
  if (a.boundary_normals != b.boundary_normals) return "boundary_normals";
  if (a.display != b.display) return "display";
  if (a.scenes != b.scenes) return "scenes";
  if (a.provenance != b.provenance) return "provenance";
  return "";
}

}  // namespace splatlas
