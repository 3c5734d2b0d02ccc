#include "preprocess/sources/fit_grid.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/content/class_table.h"
#include "format/result_macros.h"
#include "preprocess/import/meshes/surround_meshes.h"

namespace splatlas {
namespace {

const NoteKind kWidened{"widened-grid", "grid is widened for surfaces", "grids are widened for surfaces",
                        false};

Grid storage_grid_of(const SourceModel& model) {
  return reordered(model.source_grid, storage_order(model.source_grid));
}

double voxels_of(const Grid& grid) {
  double voxels = 1;
  for (const std::int64_t size : grid.size) voxels *= static_cast<double>(size);
  return voxels;
}

IndexBox box_of_labels(const MembershipVolume& memberships, const Grid& grid) {
  IndexBox box;
  const auto voxels = memberships.voxels();
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        if (voxels[static_cast<std::size_t>(grid.offset(i, j, k))] != 0) box.include(Index3{i, j, k});
      }
    }
  }
  return box;
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

std::optional<MmBox> labelled_box(const SourceModel& model) {
  if (model.source_grid.voxels() == 0) return std::nullopt;
  const Grid grid = storage_grid_of(model);
  IndexBox box = box_of_labels(model.memberships, grid);
  if (box.empty()) box = {{0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1}};
  const Affine to_mm = index_to_lps_mm(grid);
  MmBox result;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = static_cast<double>((corner >> a & 1) != 0 ? box.last[a] : box.first[a]);
    const Vec3 mm = to_mm.apply(index);
    for (std::size_t a = 0; a < 3; ++a) {
      result.low[a] = corner == 0 ? mm[a] : std::min(result.low[a], mm[a]);
      result.high[a] = corner == 0 ? mm[a] : std::max(result.high[a], mm[a]);
    }
  }
  return result;
}

Result<void> fit_grid(SourceModel& model, std::span<const TriangleMesh> meshes, bool widens, Notes& notes) {
  if (model.source_grid.voxels() == 0) {
    model.source_grid = grid_around(meshes);
    model.memberships = MembershipVolume(storage_grid_of(model).size);
    return {};
  }
  const Grid grid = storage_grid_of(model);
  const Margin margin = widens ? margin_for(grid, meshes) : Margin{};
  if (margin.empty()) return {};
  const Grid wide = widened(grid, margin);
  constexpr double kMostGrowth = 8;
  if (voxels_of(wide) > kMostGrowth * voxels_of(grid)) {
    return fail(
        ErrorCode::kLimit,
        "--fit-grid: the surfaces would widen the grid from {} to {} voxels; check their frames and scales",
        fmt::join(grid.size, "x"), fmt::join(wide.size, "x"));
  }
  widen(model, grid, margin);
  notes.add(kWidened,
            fmt::format("from {} to {} voxels", fmt::join(grid.size, "x"), fmt::join(wide.size, "x")));
  return {};
}

}  // namespace splatlas
