// Fragments in the order in which the volume pass meets them, and the volume in front of them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "format/system/thread_pool.h"
#include "player/surfaces/fragments.h"
#include "player/view/shear.h"

namespace splatlas {

struct SheetWindow;

/// Cuts across the rays, counted from the viewer, along the principal axis. Places are in voxels from the
/// slice that is nearest to the viewer. With one part a slice has one slab around it: from half a voxel in
/// front of it to half a voxel behind it. With several, what lies between two slices, and in front of the
/// first one and behind the last one as far as they reach, is cut into so many slabs of equal thickness.
struct Slabs {
  std::int64_t count = 1;
  double begin = -0.5;   ///< of the first one
  double thickness = 1;  ///< of each

  [[nodiscard]] static Slabs of(std::int64_t slices, int parts) {
    if (parts == 1) return {slices, -0.5, 1};
    return {(slices + 1) * parts, -1, 1.0 / parts};
  }
};

/// For every row of the sheet, the fragments just below it (between it and the next row), front to back by
/// slab; and for each the volume in front of its slab and with it, which the volume pass fills in.
class FragmentOrder {
 public:
  struct Entry {
    std::int32_t slab = 0;    ///< how many slabs the ray has met when it reaches the fragment's; from 0
    std::int32_t column = 0;  ///< of the sheet pixel to the left of it, in voxels
    std::int32_t phase = 0;   ///< of that pixel
    std::array<float, 4> weights{};  ///< of its four neighbours: sheet_weights(); 0 beyond the sheet
  };
  /// Place of fragments that no row of the sheet is near to: nothing is in front of them.
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  /// Keeps its memory from frame to frame. Cost: fragments, and rows of the sheet.
  void build(const FragmentList& fragments, const Shear& shear, const SheetWindow& window,
             const PictureSize& size, const Grid& grid, ThreadPool& pool);

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// Entries of a row of the sheet, from -1 to fine_rows - 1.
  [[nodiscard]] std::size_t row_begin(std::int64_t fine_row) const {
    return first_of_row_[static_cast<std::size_t>(fine_row + 1)];
  }
  [[nodiscard]] std::size_t row_end(std::int64_t fine_row) const {
    return first_of_row_[static_cast<std::size_t>(fine_row + 2)];
  }
  [[nodiscard]] const Entry& entry(std::size_t n) const { return entries_[n]; }
  [[nodiscard]] SlabRadiance* lights(std::size_t n) { return lights_.data() + n; }

  /// Has what in_front_of() will read brought near.
  void prefetch(std::size_t fragment) const {
    if (place_[fragment] != kNowhere) __builtin_prefetch(lights_.data() + place_[fragment]);
  }
  /// The volume in front of a fragment, exact for a slab of constant light.
  [[nodiscard]] Light in_front_of(std::size_t fragment, float depth) const;

  /// The slab that place `k` along the principal axis lies in (in voxels of the grid), counted from the
  /// viewer.
  [[nodiscard]] std::int32_t slab_of(double k) const { return slab_at(along_of_place(k)).slab; }

 private:
  struct Unsorted {
    std::uint32_t fragment = 0;
    Entry entry;
  };
  struct SlabPlace {
    std::int32_t slab = 0;
    float part = 0;  ///< share of the slab in front of the depth, [0, 1]
  };

  /// Voxels from the slice that is nearest to the viewer.
  [[nodiscard]] double along_of_place(double k) const {
    return ascending_ ? k : static_cast<double>(slices_ - 1) - k;
  }
  [[nodiscard]] double along_of_depth(float depth) const {
    return ascending_ ? depth : static_cast<double>(depth) + static_cast<double>(slices_ - 1);
  }
  [[nodiscard]] SlabPlace slab_at(double along) const;
  void scatter(const FragmentList& fragments, const Shear& shear, const SheetWindow& window,
               const PictureSize& size, ThreadPool& pool);
  void sort_row(std::size_t n, std::vector<std::uint32_t>& next_of_slab);

  bool ascending_ = true;
  std::int64_t slices_ = 1;
  Slabs slabs_;
  std::vector<std::size_t> first_of_row_;  // fine_rows + 2 offsets
  std::vector<Unsorted> unsorted_;         // by row
  std::vector<Entry> entries_;
  std::vector<SlabRadiance> lights_;  // of entries
  std::vector<std::uint32_t> place_;  // of fragments among the entries
};

/// Share of a slab's light that its first part gives, where the whole slab absorbs `absorbed` of what passes
/// through it and its light is constant: (1 - (1 - absorbed)^part) / absorbed.
[[nodiscard]] float share_of_slab(float absorbed, float part);

}  // namespace splatlas
