// Face of a cutting plane: voxels around it with the faces of their classes, and outlines of solids.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/class_table.h"
#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "format/tasks/thread_pool.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/clip/solid_outlines.h"
#include "player/render/decode/class_cache.h"
#include "player/render/decode/sparse_bytes.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

/// Appearance of a structure's faces.
struct FaceStyle {
  StructureIndex structure = kNoStructure;  ///< kNoStructure: no face
  std::uint32_t term = 0;                   ///< of the selection
  float opacity = 0;
  std::array<float, 3> color{};  ///< linear RGB

  [[nodiscard]] bool has_face() const { return structure != kNoStructure; }
  /// True if this face hides another one at the same point: its term is later, or within a term its index.
  [[nodiscard]] bool hides(const FaceStyle& other) const {
    return has_face() &&
           (!other.has_face() || std::pair(term, structure) > std::pair(other.term, other.structure));
  }
};

/// Face of the voxels of one class.
struct FaceClass : FaceStyle {
  static constexpr std::uint32_t kEveryVoxel = std::numeric_limits<std::uint32_t>::max();

  /// Index into the plan's classes. Its transfer function tells how much of a voxel has a face.
  /// kEveryVoxel for solids, and for a volume whose voxels are drawn as those of another structure.
  std::uint32_t draw = kEveryVoxel;
};

/// True if the faces of a structure are those of a solid: it is drawn as surface, and not as ghost.
[[nodiscard]] inline bool is_solid(const StructureDraw& draw) {
  return (draw.mode == DrawMode::kSurface || draw.mode == DrawMode::kBoth) && !draw.ghost;
}

/// Faces by ClassId. If several selected structures contain a voxel, the face is that of the latest term;
/// within a term, of the structure with the higher index. `plan` must be the plan of `selection`. Structures
/// of `without` (by StructureIndex; may be empty) have none. Linear in the memberships.
[[nodiscard]] std::vector<FaceClass> face_classes(const ClassTable& classes, const Selection& selection,
                                                  const DrawPlan& plan,
                                                  const std::vector<bool>& without = {});

/// Selection that faces can show. References must outlive the call.
struct FaceScene {
  const Atlas& atlas;
  const Selection& selection;
  const DrawPlan& plan;                                   ///< of the selection
  std::shared_ptr<const std::vector<FaceClass>> classes;  ///< of the plan, by ClassId
  const ClassCache& cache;  ///< must hold the runs of all classes with faces, and the surfaces
  Axis axis = Axis::kZ;     ///< of the runs; any axis gives the same map
  std::span<const VolumeAppearance> appearances;  ///< of the plan's classes
};

/// Structure and grey value at a point of a face.
struct FaceSample {
  const FaceStyle* style = nullptr;  ///< null: no face
  float grey = 0;  ///< interpolated between voxels with faces; 0 and 1 are the ends of the display window
};

/// The voxels within two layers of a plane, in columns along the axis nearest to its normal, and the outlines
/// of solids. A point has the face that hides all others of these:
///   - solids whose surfaces enclose it
///   - the structure with the largest share of the point between its eight voxels, except for solids with
///     closed outlines, where at least half of the point has a face at all
/// If there is none, but all eight voxels around it have whole faces, it has the face of the nearest one:
/// smoothed surfaces leave tiny gaps between three solids. Immutable and thread-safe.
class FaceMap {
 public:
  /// kLimit if the system refuses address space. Cost: linear in the decoded runs, in the triangles of solids
  /// and in the voxels near the plane. Only pages with such voxels are resident.
  [[nodiscard]] static Result<FaceMap> build(const VoxelPlane& plane, const FaceScene& scene,
                                             ThreadPool& pool);

  /// False if all voxels have grey value 1: without grey values, or with an empty display window.
  [[nodiscard]] bool has_greys() const { return has_greys_; }
  /// Axes across the columns.
  [[nodiscard]] std::size_t axis_b() const { return b_; }
  [[nodiscard]] std::size_t axis_c() const { return c_; }
  /// Calls take(n, sample) for those of the points (b, c), (b + per_step_b, c + per_step_c), ... that have a
  /// face, by continuous voxel indices along axis_b() and axis_c(). A point halfway between two voxel centres
  /// belongs to the voxel on the kept side. Points outside the map cost nothing.
  template <typename Take>
  void along(double b, double c, double per_step_b, double per_step_c, std::int64_t count,
             const Take& take) const {
    double first = 0, last = static_cast<double>(count - 1);
    const auto clip = [&](double at, double per_step, double low, double high) {
      if (per_step == 0) {
        if (!(at > low && at < high)) last = -1;
        return;
      }
      const double one = (low - at) / per_step, other = (high - at) / per_step;
      first = std::max(first, std::floor(std::min(one, other)));
      last = std::min(last, std::ceil(std::max(one, other)));
    };
    clip(b, per_step_b, low_b(), high_b());
    clip(c, per_step_c, low_c(), high_c());
    if (!(first <= last)) return;
    Cell cell;
    for (auto n = static_cast<std::int64_t>(first); n <= static_cast<std::int64_t>(last); ++n) {
      const double at_b = b + static_cast<double>(n) * per_step_b,
                   at_c = c + static_cast<double>(n) * per_step_c;
      if (!contains(at_b, at_c)) continue;
      if (const FaceSample sample = at_inside(at_b, at_c, cell); sample.style != nullptr) take(n, sample);
    }
  }

 private:
  /// Set in a texel if the voxel has a face apart from solids with outlines.
  static constexpr std::uint32_t kOwnFace = std::uint32_t{1} << 31;
  struct Texel {
    float grey = 0;
    std::uint32_t id = kEmptyClass;  // with kOwnFace
    float share = 0;                 // of the voxel that has the face

    [[nodiscard]] bool has_face() const { return id != kEmptyClass; }
    [[nodiscard]] ClassId class_id() const { return id & ~kOwnFace; }
  };
  class Builder;

  void add_solids(const VoxelPlane& plane, const FaceScene& scene, ThreadPool& pool);
  /// Points next to voxels that may have a face.
  [[nodiscard]] double low_b() const { return static_cast<double>(first_b_); }
  [[nodiscard]] double high_b() const { return static_cast<double>(first_b_ + columns_) - 1; }
  [[nodiscard]] double low_c() const { return static_cast<double>(first_c_); }
  [[nodiscard]] double high_c() const { return static_cast<double>(first_c_ + rows_) - 1; }
  [[nodiscard]] bool contains(double b, double c) const {
    return b >= low_b() && b < high_b() && c >= low_c() && c < high_c();
  }
  /// The eight voxels around a point: low and high along a, of the columns by b, then c.
  struct Cell {
    std::int64_t a = -1, b = -1, c = -1;  // of the first voxel; b and c from the first column
    std::array<const Texel*, 8> texels{};
    std::array<const FaceStyle*, 8> faces{};  // apart from solids with outlines
    bool is_empty = true;                     // no voxel has a face
    bool is_plain = false;                    // they have one face, or none apart from outlines
    bool is_whole = false;                    // all voxels have whole faces
    SolidOutlines::Cell outlines;
  };
  [[nodiscard]] Cell cell_at(std::int64_t a, std::int64_t b, std::int64_t c) const;
  /// `cell`: of the last point, or an empty one; becomes that of this point.
  [[nodiscard]] FaceSample at_inside(double b, double c, Cell& cell) const;
  /// The face and grey value at a place of a cell, from 0 to 1 along a, b and c, without outlines; none where
  /// no voxel shows a structure. Of faces with equal shares, that of the nearest voxel.
  [[nodiscard]] std::optional<FaceSample> between(const Cell& cell, double in_a, double in_b,
                                                  double in_c) const;
  [[nodiscard]] std::size_t nearest(double in_a, double in_b, double in_c) const {
    return (in_a + to_kept_ >= 0.5 ? 1u : 0u) + (in_b >= 0.5 ? 2u : 0u) + (in_c >= 0.5 ? 4u : 0u);
  }
  /// Decides between two voxels at the same distance, and between equal shares.
  static constexpr double kTie = 1e-6;
  [[nodiscard]] double height(double b, double c) const { return at_origin_ + per_b_ * b + per_c_ * c; }
  [[nodiscard]] std::size_t place(std::int64_t a, std::int64_t b, std::int64_t c) const {
    return static_cast<std::size_t>((((c - first_c_) * columns_ + (b - first_b_)) << layer_bits_) +
                                    (a & ((std::int64_t{1} << layer_bits_) - 1)));
  }
  [[nodiscard]] const Texel* texels() const { return reinterpret_cast<const Texel*>(texels_.data()); }

  std::size_t a_ = 2, b_ = 0, c_ = 1;             // columns run along a
  double at_origin_ = 0, per_b_ = 0, per_c_ = 0;  // position of the plane along a
  double reach_ = 0;                              // change of that position within a voxel along b and c
  double to_kept_ = 0;                            // tiny step along a into the kept part
  std::int64_t first_b_ = 0, first_c_ = 0;        // of the padded box of voxels with faces
  std::int64_t columns_ = 0, rows_ = 0;           // along b and c
  bool has_greys_ = false;
  int layer_bits_ = 1;  // layers of a column: 2^layer_bits, by position mod them
  SparseBytes texels_;
  std::shared_ptr<const std::vector<FaceClass>> classes_;  // by ClassId: of all structures
  std::shared_ptr<const std::vector<FaceClass>> apart_;    // the same without solids that have outlines
  std::vector<FaceStyle> solids_;                          // of outlines_
  SolidOutlines outlines_;
};

inline FaceSample FaceMap::at_inside(double b, double c, Cell& cell) const {
  // Find the cell. Conversion rounds positive numbers down; std::floor() is a call
  constexpr double kPositive = 1 << 26;  // beyond any grid, and a multiple of the number of layers
  const double a = height(b, c) + kPositive;
  const double from_b = b - static_cast<double>(first_b_), from_c = c - static_cast<double>(first_c_);
  const auto a0 = static_cast<std::int64_t>(a), b0 = static_cast<std::int64_t>(from_b),
             c0 = static_cast<std::int64_t>(from_c);
  if (a0 != cell.a || b0 != cell.b || c0 != cell.c) cell = cell_at(a0, b0, c0);
  if (cell.is_empty) return {};
  const double in_a = a - static_cast<double>(a0), in_b = from_b - static_cast<double>(b0),
               in_c = from_c - static_cast<double>(c0);

  // Find the face that hides all others
  FaceSample sample;
  if (cell.is_plain) {
    const auto mix = [](float from, float to, double at) {
      return from + static_cast<float>(at) * (to - from);
    };
    const auto grey = [&](std::size_t column) {
      return mix(cell.texels[column]->grey, cell.texels[column + 1]->grey, in_a);
    };
    sample = {cell.faces[0], mix(mix(grey(0), grey(2), in_b), mix(grey(4), grey(6), in_b), in_c)};
  } else {
    const std::optional<FaceSample> mixed = between(cell, in_a, in_b, in_c);
    if (!mixed) return {};
    sample = *mixed;
  }
  if (solids_.empty()) return sample;
  if (const std::uint32_t solid = outlines_.at(cell.outlines, b, c); solid != SolidOutlines::kNone) {
    if (sample.style == nullptr || solids_[solid].hides(*sample.style)) sample.style = &solids_[solid];
  }
  if (sample.style == nullptr && cell.is_whole)
    sample.style = &(*classes_)[cell.texels[nearest(in_a, in_b, in_c)]->class_id()];
  return sample;
}

}  // namespace splatlas
