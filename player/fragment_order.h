// Fragments in the order in which the volume pass meets them.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "player/fragments.h"
#include "player/shear.h"
#include "player/thread_pool.h"

namespace splatlas {

struct SheetWindow;

/// For every row of the sheet, the fragments just below it (between it and the next row), front to back by
/// slab.
class FragmentOrder {
 public:
  struct Entry {
    std::uint32_t fragment = 0;
    std::int32_t slab = 0;         ///< how many slabs the ray has met when it reaches the fragment's; from 0
    float slab_part = 0;           ///< share of that slab in front of the fragment, [0, 1]
    std::int32_t x = 0;            ///< sheet pixel to the left of it
    float x_part = 0, y_part = 0;  ///< where between the pixel (and row) and the next, [0, 1)
  };
  static constexpr std::int32_t kBehindEverything = std::numeric_limits<std::int32_t>::max();

  /// Also sets every fragment's `above` and `below` to "nothing in front", for rows that the window does not
  /// have.
  FragmentOrder(FragmentList& fragments, const Shear& shear, const SheetWindow& window,
                const PictureSize& size, const Grid& grid, ThreadPool& pool);

  /// Entries of a row of the sheet, from -1 to fine_rows - 1.
  [[nodiscard]] std::size_t row_begin(std::int64_t fine_row) const {
    return first_of_row_[static_cast<std::size_t>(fine_row + 1)];
  }
  [[nodiscard]] std::size_t row_end(std::int64_t fine_row) const {
    return first_of_row_[static_cast<std::size_t>(fine_row + 2)];
  }
  [[nodiscard]] const Entry& entry(std::size_t n) const { return entries_[n]; }

  /// The slab of slice `k` of the grid, counted from the viewer.
  [[nodiscard]] std::int32_t slab_of(std::int64_t k) const {
    return static_cast<std::int32_t>(ascending_ ? k : slices_ - 1 - k);
  }

 private:
  bool ascending_;
  std::int64_t slices_;
  std::vector<std::size_t> first_of_row_;  // fine_rows + 2 offsets
  std::vector<Entry> entries_;
};

}  // namespace splatlas
