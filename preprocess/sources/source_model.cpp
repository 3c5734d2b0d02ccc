#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/content/class_table.h"
#include "format/result_macros.h"
#include "preprocess/import/images/import_image.h"
#include "preprocess/import/meshes/import_mesh.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/sources/import_sources.h"

namespace splatlas {
namespace {

/// The box of all corners, mapped by `place`: to mm or to indices.
template <typename Place>
MmBox box_of_points(std::span<const TriangleMesh> meshes, const Place& place) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  MmBox box{{kInfinite, kInfinite, kInfinite}, {-kInfinite, -kInfinite, -kInfinite}};
  for (const TriangleMesh& mesh : meshes) {
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        const Vec3 at = place(mesh.positions_lps_mm[corner]);
        for (std::size_t a = 0; a < 3; ++a) {
          box.low[a] = std::min(box.low[a], at[a]);
          box.high[a] = std::max(box.high[a], at[a]);
        }
      }
    }
  }
  return box;
}

/// The voxels that a grid lacks to hold all points of the meshes, and one more.
Margin margin_for(const Grid& grid, std::span<const TriangleMesh> meshes) {
  const Affine to_index = lps_mm_to_index(grid);
  const MmBox box = box_of_points(meshes, [&](const Vec3& mm) { return to_index.apply(mm); });
  Margin margin;
  for (std::size_t a = 0; a < 3; ++a) {
    const double first = std::floor(box.low[a] + 0.5) - 1, last = std::ceil(box.high[a] - 0.5) + 1;
    const auto end = static_cast<double>(grid.size[a] - 1);
    constexpr double kMost = static_cast<double>(kMaxAxisSize);
    if (first < 0 && box.low[a] < -0.5) margin.low[a] = static_cast<std::int64_t>(std::min(-first, kMost));
    if (last > end && box.high[a] > end + 0.5)
      margin.high[a] = static_cast<std::int64_t>(std::min(last - end, kMost));
  }
  return margin;
}

double longest_side(const MmBox& box) {
  return std::ranges::max(difference(box.high, box.low));
}

/// A grid around meshes alone: cubic voxels, 256 along the longest side, and a voxel of margin.
Grid grid_around(std::span<const TriangleMesh> meshes, Notes& notes) {
  constexpr double kVoxels = 256, kLeast = 2, kMost = 5000;  // mm, smaller than organs, larger than bodies
  const MmBox box = box_of_points(meshes, [](const Vec3& mm) { return mm; });
  const double longest = longest_side(box);
  if (longest < kLeast || longest > kMost)
    notes.add("surface-sizes", fmt::format("the longest side of all is {:.3g} mm; give a scale", longest));
  const double spacing = std::max(longest / kVoxels, kMinSpacingMm);
  Grid grid;
  grid.spacing_mm = {spacing, spacing, spacing};
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<std::int64_t>(std::floor((box.high[a] - box.low[a]) / spacing)) + 3;
    grid.origin_lps_mm[a] = box.low[a] - spacing;
  }
  return grid;
}

void widen(SourceModel& model, const Grid& grid, const Margin& margin) {
  model.memberships.widen(margin);
  for (SourceModel::Segment& segment : model.segments) {
    if (!segment.mask.empty()) segment.mask = widened<std::uint8_t>(segment.mask, grid.size, margin, 0);
  }
  if (!model.values.empty()) {
    visit_voxel_type(model.values.type, [&]<typename T>(T) {
      const std::span<const T> values(model.values.as<T>(), static_cast<std::size_t>(grid.voxels()));
      const std::vector<T> wider = widened<T>(values, grid.size, margin, std::ranges::min(values));
      const auto bytes = std::as_bytes(std::span(wider));
      model.values.bytes.assign(bytes.begin(), bytes.end());
    });
  }
  model.source_grid = widened(model.source_grid, before_reordering(margin, storage_order(model.source_grid)));
}

}  // namespace

MmBox box_of(const TriangleMesh& mesh) {
  return box_of_points({&mesh, 1}, [](const Vec3& mm) { return mm; });
}

std::optional<MmBox> labelled_box(const SourceModel& model) {
  if (model.source_grid.voxels() == 0) return std::nullopt;
  const Grid grid = model.storage_grid();
  const auto voxels = model.memberships.voxels();
  IndexBox box;
  for (std::int64_t v = 0; v < grid.voxels(); ++v) {
    if (voxels[static_cast<std::size_t>(v)] == 0) continue;
    const std::int64_t row = v / grid.size[0];
    const Index3 voxel{v % grid.size[0], row % grid.size[1], row / grid.size[1]};
    box.include({voxel, voxel});
  }
  if (box.empty()) box = {{0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1}};
  const auto [low, high] = box_lps_mm(grid, box.first, box.last);
  return MmBox{low, high};
}

void note_size(const SourceModel& model, const MeshSource& source, const TriangleMesh& mesh,
               const MmBox& labelled, Notes& notes) {
  constexpr double kMostRatio = 100;
  constexpr std::array<std::pair<double, const char*>, 5> kUnits{
      {{1000, "m"}, {25.4, "inches"}, {10, "cm"}, {1e-3, "um"}, {1e-6, "nm"}}};
  const double voxel = std::ranges::min(model.source_grid.spacing_mm), size = longest_side(box_of(mesh)),
               usual = std::max(longest_side(labelled), voxel);
  if (size >= voxel && size >= usual / kMostRatio && size <= usual * kMostRatio) return;
  const auto [scale, unit] = *std::ranges::min_element(
      kUnits, {}, [&](const auto& known) { return std::abs(std::log(known.first * size / usual)); });
  notes.add(
      "surface-sizes",
      fmt::format(
          "{} (its longest side is {:.3g} mm, that of the labels {:.3g} mm; scale={} if its unit is {})",
          source.file.string(), size, usual, scale * source.scale.value_or(1), unit));
}

Result<void> fit_grid(SourceModel& model, std::span<const TriangleMesh> meshes, bool widens, Notes& notes) {
  if (model.source_grid.voxels() == 0) {
    model.source_grid = grid_around(meshes, notes);
    model.memberships = MembershipVolume(model.storage_grid().size);
    return {};
  }
  const Grid grid = model.storage_grid();
  const Margin margin = widens ? margin_for(grid, meshes) : Margin{};
  if (margin.empty()) return {};
  const Grid wide = widened(grid, margin);
  constexpr std::int64_t kMostGrowth = 8;
  if (wide.voxels() > kMostGrowth * grid.voxels()) {
    return fail(
        ErrorCode::kLimit,
        "--fit-grid: the surfaces would widen the grid from {} to {} voxels; check their frames and scales",
        fmt::join(grid.size, "x"), fmt::join(wide.size, "x"));
  }
  widen(model, grid, margin);
  notes.add("widened-grid",
            fmt::format("from {} to {} voxels", fmt::join(grid.size, "x"), fmt::join(wide.size, "x")));
  return {};
}

std::vector<std::filesystem::path> list_files(const SourceFiles& files) {
  std::vector<std::filesystem::path> list;
  std::vector<std::filesystem::path> given{files.labels, files.volume, files.names, files.tree, files.sides};
  for (const LabelsFile& more : files.more_labels) given.push_back(more.file);
  for (const MeshSource& mesh : files.meshes) given.insert(given.end(), {mesh.file, mesh.transform});
  std::error_code unreadable;
  for (const std::filesystem::path& path : given) {
    if (!path.empty()) std::ranges::move(regular_files_of(path, unreadable), std::back_inserter(list));
  }
  for (const SegmentRule& rule : files.segments) {
    if (!rule.mask.empty()) list.push_back(rule.mask);
  }
  for (std::size_t n = list.size(); n-- > 0;) list.push_back(other_file(list[n]));
  list.insert(list.end(), files.scenes.begin(), files.scenes.end());
  return list;
}

std::vector<std::uint8_t> sides_of_plane(const Grid& grid, double x_mm) {
  const Affine to_mm = index_to_lps_mm(grid);
  const double least = x_mm - 1e-6 * std::ranges::min(grid.spacing_mm);  // despite rounding
  std::vector<std::uint8_t> sides;
  sides.reserve(static_cast<std::size_t>(grid.voxels()));
  for (std::int64_t v = 0; v < grid.voxels(); ++v) {
    const std::int64_t row = v / grid.size[0], j = row % grid.size[1], k = row / grid.size[1];
    const Vec3 index{static_cast<double>(v % grid.size[0]), static_cast<double>(j), static_cast<double>(k)};
    sides.push_back(to_mm.apply(index)[0] >= least ? 1 : 2);
  }
  return sides;
}

Result<std::vector<std::uint8_t>> sides_of_image(const VoxelBuffer& image,
                                                 const std::filesystem::path& file) {
  return visit_voxel_type(image.type, [&]<typename T>(T) -> Result<std::vector<std::uint8_t>> {
    std::vector<std::uint8_t> sides;
    for (const T value : std::span(image.as<T>(), image.bytes.size() / sizeof(T))) {
      if (value != T(0) && value != T(1) && value != T(2))
        return bad_file(file, "holds the value {}; the sides are 1 (left) and 2 (right)", value);
      sides.push_back(static_cast<std::uint8_t>(value));
    }
    for (const int side : {1, 2}) {
      if (std::ranges::find(sides, side) == sides.end())
        return bad_file(file, "has no voxel of {} within the grid; the sides are 1 (left) and 2 (right)",
                        side);
    }
    return sides;
  });
}

void split_sides(SourceModel& model, std::span<const std::uint8_t> sides, const std::string& where,
                 Notes& notes) {
  constexpr std::uint64_t kLeastShare = 100;  // one of so many voxels
  const auto sets = model.memberships.sets();
  std::vector<std::array<std::uint64_t, 3>> of_set(sets.size()), voxels(model.structures.size());
  for (std::size_t v = 0; v < sides.size(); ++v) ++of_set[model.memberships.voxels()[v]][sides[v]];
  for (std::size_t set = 0; set < sets.size(); ++set) {
    for (const StructureIndex s : sets[set]) {
      for (std::size_t side = 0; side < 3; ++side) voxels[s][side] += of_set[set][side];
    }
  }
  std::vector<std::array<StructureIndex, 3>> numbers;  // [structure][side]
  for (StructureIndex s = 0; s < voxels.size(); ++s) {
    numbers.push_back({s, s, s});
    const auto [none, left, right] = voxels[s];
    if (left == 0 || right == 0 || kLeastShare * std::min(left, right) < none + left + right) continue;
    const SourceStructure whole = model.structures[s];
    notes.add("split-structures", fmt::format("{} ({} and {} voxels)", whole.name, left, right));
    for (const std::size_t side : {1, 2}) {
      numbers[s][side] = static_cast<StructureIndex>(model.structures.size());
      model.structures.push_back(
          {.name = whole.name + (side == 1 ? " left" : " right"), .color = whole.color, .whole = s});
    }
  }
  if (numbers.size() == model.structures.size()) return notes.add("sides-unused", where);
  model.memberships.combine(sides, [&](std::vector<StructureIndex> set, std::uint8_t side) {
    for (StructureIndex& s : set) s = numbers[s][side];
    std::ranges::sort(set);
    return set;
  });
}

}  // namespace splatlas
