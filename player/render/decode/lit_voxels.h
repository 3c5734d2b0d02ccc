// Voxels whose emission depends on the view (hybrid shading).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/content/unit_vector.h"

namespace splatlas {

/// A voxel that is lit by its normal.
struct LitVoxel {
  /// `lit` of voxels whose whole emission depends on the normal.
  static constexpr std::uint16_t kAllLit = 65535;

  float white = 0;  ///< unlit emission of white, 1/mm
  PackedNormal normal = 0;
  std::uint16_t lit = kAllLit;  ///< share of the emission that depends on the normal

  /// The lit emission of white, given the factor of the part that depends on the normal.
  [[nodiscard]] float lit_white(float factor) const {
    return white * (1 + static_cast<float>(lit) / kAllLit * (factor - 1));
  }
  friend bool operator==(const LitVoxel&, const LitVoxel&) = default;
};

/// Lit voxels with consecutive numbers and one colour.
struct LitRun {
  std::uint32_t number = 0;            ///< of the first voxel in its slice
  std::uint32_t first = 0, count = 0;  ///< in LitVoxels::voxels
  std::array<float, 3> color{};        ///< linear; their emissions are those of white times the colour

  [[nodiscard]] std::uint32_t end() const { return number + count; }
  friend bool operator==(const LitRun&, const LitRun&) = default;
};

/// The lit voxels of a slice, by ascending number.
struct LitVoxels {
  std::vector<LitRun> runs;
  std::vector<LitVoxel> voxels;

  void clear() {
    runs.clear();
    voxels.clear();
  }
  /// Begins a run unless the last one goes on. `first`: index of its first voxel.
  void begin_run(std::uint32_t number, std::size_t first, const std::array<float, 3>& color) {
    if (runs.empty() || runs.back().end() != number || runs.back().color != color)
      runs.push_back({number, static_cast<std::uint32_t>(first), 0, color});
  }
  /// Appends a voxel to the last run, or to a new one behind a gap or with another colour.
  void add(std::uint32_t number, const LitVoxel& voxel, const std::array<float, 3>& color) {
    begin_run(number, voxels.size(), color);
    ++runs.back().count;
    voxels.push_back(voxel);
  }
  friend bool operator==(const LitVoxels&, const LitVoxels&) = default;
};

/// Finds lit voxels by ascending number. O(1) amortised.
class LitCursor {
 public:
  explicit LitCursor(const LitVoxels& of) : of_(&of) {}

  /// Null unless the voxel is lit. Valid until the next call, together with color().
  [[nodiscard]] const LitVoxel* find(std::uint32_t number) {
    while (run_ < of_->runs.size() && of_->runs[run_].end() <= number) ++run_;
    if (run_ == of_->runs.size() || number < of_->runs[run_].number) return nullptr;
    return &of_->voxels[of_->runs[run_].first + (number - of_->runs[run_].number)];
  }
  [[nodiscard]] const std::array<float, 3>& color() const { return of_->runs[run_].color; }

 private:
  const LitVoxels* of_;
  std::size_t run_ = 0;
};

}  // namespace splatlas
