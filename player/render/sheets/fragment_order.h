// Surface fragments sorted by sheet row and slab, with the radiance of the volume in front of them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/view/shear.h"

namespace splatlas {

struct SheetWindow;

/// Slabs across the principal axis, in front-to-back order. Positions are in voxels from the slice nearest to
/// the viewer. With one part, each slice is the centre of a slab one voxel thick. With more parts, each
/// interval between two slices has `parts` slabs of equal thickness. The intervals in front of the first
/// slice and behind the last one count, too.
struct Slabs {
  std::int64_t count = 1;
  double begin = -0.5;   ///< position of the first slab
  double thickness = 1;  ///< in voxels

  [[nodiscard]] static Slabs of(std::int64_t slices, int parts) {
    if (parts == 1) return {slices, -0.5, 1};
    return {(slices + 1) * parts, -1, 1.0 / parts};
  }
};

/// Fragments between each row of the sheet and the next one, front to back by slab. The volume pass fills in
/// the radiance of the volume in front of each fragment's slab, without and with the slab.
class FragmentOrder {
 public:
  struct Entry {
    std::int32_t slab = 0;     ///< index from the viewer
    std::uint32_t sample = 0;  ///< of the fragment
  };
  /// Place of a sample in the sheet.
  struct SheetPlace {
    std::int32_t row = kNoRow;       ///< fine row above the sample, from -1; kNoRow without a neighbour
    std::int32_t column = 0;         ///< of the sheet pixel to the left, in voxels
    std::int32_t phase = 0;          ///< of that pixel
    std::array<float, 4> weights{};  ///< of the four neighbours: sheet_weights(); 0 outside the sheet
  };
  static constexpr std::int32_t kNoRow = std::numeric_limits<std::int32_t>::min();
  struct SlabPlace {
    std::int32_t slab = 0;
    float part = 0;  ///< share of the slab in front of the depth, [0, 1]
  };
  /// Place of fragments without a neighbouring row of the sheet, with no volume in front of them.
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

  /// Sorts the fragments of a frame. Keeps its memory from frame to frame. Linear in fragments and rows of
  /// the sheet.
  void build(const FragmentList& fragments, const Shear& shear, const SheetWindow& window,
             const PictureSize& size, const Grid& grid, ThreadPool& pool);

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  /// Range of the entries of a row of the sheet, -1 to fine_rows - 1.
  [[nodiscard]] std::size_t row_begin(std::int64_t fine_row) const {
    return first_of_row_[static_cast<std::size_t>(fine_row + 1)];
  }
  [[nodiscard]] std::size_t row_end(std::int64_t fine_row) const {
    return first_of_row_[static_cast<std::size_t>(fine_row + 2)];
  }
  [[nodiscard]] const Entry& entry(std::size_t n) const { return entries_[n]; }
  [[nodiscard]] const SheetPlace& place_of_sample(std::uint32_t n) const { return samples_[n]; }
  [[nodiscard]] SlabRadiance* radiance(std::size_t n) { return radiance_.data() + n; }

  /// Prefetches the input of in_front_of().
  void prefetch(std::size_t fragment) const {
    if (place_[fragment] != kNowhere) __builtin_prefetch(radiance_.data() + place_[fragment]);
  }
  /// Radiance of the volume in front of a fragment, exact for a slab of constant optical properties. `kept`:
  /// kept part of its ray; null without a cut.
  [[nodiscard]] Radiance in_front_of(std::size_t fragment, float depth, const ClipDepths* kept) const;

  /// Place of a depth among the slabs.
  [[nodiscard]] SlabPlace place_of_depth(double depth) const { return slab_at(along_of_depth(depth)); }
  /// Index of the slab that contains position `k` along the principal axis, in voxels of the grid.
  [[nodiscard]] std::int32_t slab_of(double k) const { return slab_at(along_of_place(k)).slab; }

 private:
  struct Unsorted {
    std::uint32_t fragment = 0;
    Entry entry;
  };

  /// Position in voxels from the slice nearest to the viewer.
  [[nodiscard]] double along_of_place(double k) const {
    return ascending_ ? k : static_cast<double>(slices_ - 1) - k;
  }
  [[nodiscard]] double along_of_depth(double depth) const {
    return ascending_ ? depth : depth + static_cast<double>(slices_ - 1);
  }
  [[nodiscard]] SlabPlace slab_at(double along) const;
  /// Share of the kept part of a slab in front of a depth.
  [[nodiscard]] float kept_part(std::int32_t slab, double depth, const ClipDepths& kept) const;
  void scatter(const FragmentList& fragments, ThreadPool& pool);
  void sort_row(std::size_t n, std::vector<std::uint32_t>& next_of_slab);
  void put(const Unsorted& from, std::size_t to);

  bool ascending_ = true;
  std::int64_t slices_ = 1;
  Slabs slabs_;
  std::vector<std::size_t> first_of_row_;  // fine_rows + 2 offsets
  std::vector<SheetPlace> samples_;
  std::vector<Unsorted> unsorted_;  // by row
  std::vector<Entry> entries_;
  std::vector<SlabRadiance> radiance_;  // of entries
  std::vector<std::uint32_t> place_;    // index of each fragment's entry
};

/// Share of a homogeneous slab's radiance that its front `part` contributes. With `absorbed`, the opacity of
/// the whole slab, it is (1 - (1 - absorbed)^part) / absorbed.
[[nodiscard]] float share_of_slab(float absorbed, float part);
/// The same from the accumulated opacities in front of the slab and behind it.
[[nodiscard]] float share_in_slab(float before, float behind, float part);

}  // namespace splatlas
