// Shares of structures in the volume in front of surface fragments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "player/picture.h"

namespace splatlas {

/// Part of the share of a structure in front of a fragment's slab, or of the slab and all in front of it.
struct FragmentShare {
  std::uint32_t entry = 0;  ///< FragmentOrder::entry()
  StructureNumber number = 0;
  bool before = false, behind = false;  ///< without the slab, with the slab
  float share = 0;
};

/// The shares of all fragments of a sheet, by entry of the FragmentOrder.
class FragmentShares {
 public:
  /// Replaces the content. Cost: linear in entries and shares.
  void build(std::size_t entries, std::span<const std::vector<FragmentShare>> of_bands) {
    first_.assign(entries + 2, 0);
    for (const auto& of_band : of_bands) {
      for (const FragmentShare& share : of_band) ++first_[share.entry + 2];
    }
    for (std::size_t n = 2; n < first_.size(); ++n) first_[n] += first_[n - 1];
    shares_.resize(first_.back());
    for (const auto& of_band : of_bands) {
      for (const FragmentShare& share : of_band) shares_[first_[share.entry + 1]++] = share;
    }
  }
  [[nodiscard]] std::span<const FragmentShare> of_entry(std::size_t entry) const {
    return std::span(shares_).subspan(first_[entry], first_[entry + 1] - first_[entry]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<FragmentShare> shares_;
};

}  // namespace splatlas
