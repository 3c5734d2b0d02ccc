#include "preprocess/import/widen_grid.h"

namespace splatlas {

Grid widened(const Grid& grid, const Margin& margin) {
  Grid wide = grid;
  Vec3 first;
  for (std::size_t a = 0; a < 3; ++a) {
    wide.size[a] += margin.low[a] + margin.high[a];
    first[a] = -static_cast<double>(margin.low[a]);
  }
  wide.origin_lps_mm = index_to_lps_mm(grid).apply(first);
  return wide;
}

Margin before_reordering(const Margin& margin, const AxisOrder& order) {
  Margin source;
  for (std::size_t a = 0; a < 3; ++a) {
    source.low[order.from[a]] = order.flipped[a] ? margin.high[a] : margin.low[a];
    source.high[order.from[a]] = order.flipped[a] ? margin.low[a] : margin.high[a];
  }
  return source;
}

}  // namespace splatlas
