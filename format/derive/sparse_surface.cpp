#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "format/derive/fit_surface.h"
#include "format/derive/structure_crop.h"
#include "format/derive/surface_net.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Offsets in a grid with one more voxel before and behind every side.
class PaddedGrid {
 public:
  explicit PaddedGrid(const Index3& size) : width_(size[0] + 2), height_(size[1] + 2) {}
  [[nodiscard]] std::uint64_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::uint64_t>(((k + 1) * height_ + j + 1) * width_ + i + 1);
  }
  [[nodiscard]] Index3 index(std::uint64_t offset) const {
    const auto at = static_cast<std::int64_t>(offset);
    return {at % width_ - 1, at / width_ % height_ - 1, at / width_ / height_ - 1};
  }

 private:
  std::int64_t width_, height_;
};

/// A cell with corners inside and outside.
struct SparseCell {
  std::uint64_t offset = 0;            ///< padded offset of corner 0
  std::uint64_t leading = 0;           ///< padded offset of the first boundary voxel, or 0
  std::array<std::uint32_t, 3> ids{};  ///< of the vertices on the edges from corner 0, see NetBuilder
  std::uint8_t inside = 0;
};

/// Visits the cells between four rows: (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1).
class CellRow {
 public:
  CellRow(const PartRows& rows, std::int64_t j, std::int64_t k) {
    for (std::size_t n = 0; n < 4; ++n) {
      rows_[n] = rows.row(j + static_cast<std::int64_t>(n & 1), k + static_cast<std::int64_t>(n >> 1));
      for (const PartRun& run : rows_[n]) {
        changes_.push_back(run.start);
        changes_.push_back(run.end);
      }
    }
    std::ranges::sort(changes_);
    changes_.erase(std::unique(changes_.begin(), changes_.end()), changes_.end());
  }

  /// Calls visit(i, parts) for every cell with corners inside and outside. parts[c] is the part of corner c.
  template <typename Visit>
  void for_each_crossed_cell(const Visit& visit) {
    Column before{};
    for (std::size_t n = 0; n < changes_.size(); ++n) {
      const Column column = column_at(changes_[n]);
      visit_cell(changes_[n] - 1, before, column, visit);
      // Columns are equal up to the next change
      const std::int64_t end = n + 1 < changes_.size() ? changes_[n + 1] : changes_[n] + 1;
      if (is_crossed(column, column)) {
        for (std::int64_t i = changes_[n]; i + 1 < end; ++i) visit_cell(i, column, column, visit);
      }
      before = column;
    }
  }

 private:
  using Column = std::array<std::uint8_t, 4>;  // [row]: part

  [[nodiscard]] Column column_at(std::int64_t i) {
    Column column{};
    for (std::size_t n = 0; n < 4; ++n) {
      while (next_[n] < rows_[n].size() && rows_[n][next_[n]].end <= i) ++next_[n];
      if (next_[n] < rows_[n].size() && rows_[n][next_[n]].start <= i) column[n] = rows_[n][next_[n]].part;
    }
    return column;
  }
  [[nodiscard]] static bool is_crossed(const Column& a, const Column& b) {
    const auto inside = [](const Column& column) {
      return std::ranges::count_if(column, [](std::uint8_t part) { return part != 0; });
    };
    const auto count = inside(a) + inside(b);
    return count != 0 && count != 8;
  }
  template <typename Visit>
  static void visit_cell(std::int64_t i, const Column& low, const Column& high, const Visit& visit) {
    if (!is_crossed(low, high)) return;
    std::array<std::uint8_t, 8> parts{};
    for (std::size_t row = 0; row < 4; ++row) {
      parts[2 * row] = low[row];
      parts[2 * row + 1] = high[row];
    }
    visit(i, parts);
  }

  std::array<std::span<const PartRun>, 4> rows_;
  std::array<std::size_t, 4> next_{};
  std::vector<std::int64_t> changes_;
};

/// Rows (k, j) of cells next to an occupied row of voxels, in order.
std::vector<std::pair<std::int64_t, std::int64_t>> cell_rows(const PartRows& rows) {
  std::vector<std::pair<std::int64_t, std::int64_t>> found;
  found.reserve(4 * rows.rows().size());
  for (const PartRows::Row& row : rows.rows()) {
    for (const std::int64_t k : {row.k - 1, row.k}) {
      for (const std::int64_t j : {row.j - 1, row.j}) found.emplace_back(k, j);
    }
  }
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

Index3 corner_of(const Index3& cell, unsigned corner) {
  return {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)};
}

SparseCell sparse_cell(const Index3& cell, const std::array<std::uint8_t, 8>& parts, const PaddedGrid& grid) {
  SparseCell result{.offset = grid.offset(cell[0], cell[1], cell[2])};
  for (unsigned corner = 8; corner-- > 0;) {
    if (parts[corner] == StructureCrop::kOutside) continue;
    result.inside = static_cast<std::uint8_t>(result.inside | 1u << corner);
    const Index3 at = corner_of(cell, corner);
    if (parts[corner] == StructureCrop::kBoundary) result.leading = grid.offset(at[0], at[1], at[2]);
  }
  return result;
}

/// All cells in memory order, or nothing if they have more than `max_triangles` triangles.
std::optional<std::vector<SparseCell>> find_cells(const PartRows& rows, const PaddedGrid& grid,
                                                  std::uint64_t max_triangles) {
  std::vector<SparseCell> cells;
  std::uint64_t triangles = 0;
  for (const auto& row : cell_rows(rows)) {
    check_task();
    const auto k = row.first, j = row.second;
    CellRow(rows, j, k).for_each_crossed_cell([&](std::int64_t i, const std::array<std::uint8_t, 8>& parts) {
      if (triangles > max_triangles) return;
      cells.push_back(sparse_cell({i, j, k}, parts, grid));
      triangles += cell_cases()[cells.back().inside].triangle_count;
    });
    if (triangles > max_triangles) return std::nullopt;
  }
  return cells;
}

/// The cells with corner 0 at the corners of a cell. All with a crossed edge there are in the list.
std::array<SparseCell*, 8> cells_at_corners(std::vector<SparseCell>& cells, std::size_t n,
                                            const PaddedGrid& grid) {
  std::array<SparseCell*, 8> found{};
  const Index3 cell = grid.index(cells[n].offset);
  auto next = cells.begin() + static_cast<std::ptrdiff_t>(n);
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Index3 at = corner_of(cell, corner);
    next = std::ranges::lower_bound(next, cells.end(), grid.offset(at[0], at[1], at[2]), {},
                                    &SparseCell::offset);
    if (next == cells.end()) break;
    found[corner] = &*next;
  }
  return found;
}

}  // namespace

std::optional<SurfaceNet> sparse_surface_net(const PartRows& rows, std::uint64_t max_triangles) {
  const PaddedGrid grid(rows.size());
  // Cells and vertices have 32-bit numbers. There are no more of them than triangles: a cell has one or more,
  // and a vertex four or more with three vertices each.
  max_triangles = std::min<std::uint64_t>(max_triangles, std::numeric_limits<std::uint32_t>::max());
  std::optional<std::vector<SparseCell>> cells = find_cells(rows, grid, max_triangles);
  if (!cells) return std::nullopt;
  std::vector<std::uint32_t> order(cells->size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t n) { return (*cells)[n].leading; });
  NetBuilder builder(cells->size());
  TaskPace pace;
  for (std::size_t n = 0; n < order.size(); ++n) {
    pace.step();
    const Index3 cell = grid.index((*cells)[order[n]].offset);
    const std::array<SparseCell*, 8> at_corners = cells_at_corners(*cells, order[n], grid);
    builder.add_cell(
        {static_cast<std::int32_t>(cell[0]), static_cast<std::int32_t>(cell[1]),
         static_cast<std::int32_t>(cell[2])},
        (*cells)[order[n]].inside,
        [&](const CellEdge& edge) -> std::uint32_t& { return at_corners[edge.corner]->ids[edge.axis]; },
        [](const CellEdge&) { return 1u; });
  }
  return builder.finish();
}

SparseGradient::SparseGradient(const PartRows& rows) : rows_(rows) {
  for (std::size_t bits = 0; bits < smooth_.size(); ++bits) {
    for (std::size_t t = 0; t < static_cast<std::size_t>(kTaps); ++t) {
      const float covered = bits >> t & 1 ? 1.0f : 0.0f;
      smooth_[bits] += kernels_.gauss[t] * covered;
      derived_[bits] += kernels_.derivative[t] * covered;
    }
  }
}

void SparseGradient::go_to_row(std::int64_t j, std::int64_t k) {
  for (std::int64_t slice = 0; slice < kTaps; ++slice) {
    for (std::int64_t row = 0; row < kTaps; ++row) {
      around_[static_cast<std::size_t>(slice * kTaps + row)] = {
          rows_.row(j + row - GradientKernels::kRadius, k + slice - GradientKernels::kRadius), 0};
    }
  }
  j_ = j;
  k_ = k;
  placed_ = true;
}

unsigned SparseGradient::covered(RowCursor& row, std::int64_t i) {
  const std::int64_t first = i - GradientKernels::kRadius;
  while (row.next < row.runs.size() && row.runs[row.next].end <= first) ++row.next;
  unsigned bits = 0;
  for (std::size_t n = row.next; n < row.runs.size() && row.runs[n].start < first + kTaps; ++n) {
    const auto from = static_cast<unsigned>(std::max<std::int64_t>(row.runs[n].start - first, 0));
    const auto to = static_cast<unsigned>(std::min<std::int64_t>(row.runs[n].end - first, kTaps));
    bits |= (1u << to) - (1u << from);
  }
  return bits;
}

std::array<float, 3> SparseGradient::at(std::int64_t i, std::int64_t j, std::int64_t k) {
  if (!placed_ || j != j_ || k != k_ || i < i_) go_to_row(j, k);
  i_ = i;
  std::array<float, 3> gradient{0, 0, 0};
  for (std::size_t slice = 0; slice < static_cast<std::size_t>(kTaps); ++slice) {
    float smooth = 0, along_j = 0, along_i = 0;
    for (std::size_t row = 0; row < static_cast<std::size_t>(kTaps); ++row) {
      const unsigned bits = covered(around_[slice * kTaps + row], i);
      smooth += kernels_.gauss[row] * smooth_[bits];
      along_j += kernels_.derivative[row] * smooth_[bits];
      along_i += kernels_.gauss[row] * derived_[bits];
    }
    gradient[0] += kernels_.gauss[slice] * along_i;
    gradient[1] += kernels_.gauss[slice] * along_j;
    gradient[2] += kernels_.derivative[slice] * smooth;
  }
  return gradient;
}

}  // namespace splatlas
