#include "player/render/rays/volume/ray_volume.h"

#include <cmath>
#include <cstring>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "player/transfer_function.h"

namespace splatlas {
namespace {

/// Limit of stored grey values. Points of transfer functions lie within 1e5 of 0, so clamping shifts their
/// crossings by at most 1e-4 of the distance between voxels.
constexpr double kLargestStored = 1e9;
constexpr std::uint64_t kPageBytes = 4096;

}  // namespace

/// Builds a ray volume.
class RayVolume::Builder {
 public:
  Builder(const RayVolumeRequest& request, RayVolume& volume, ThreadPool& pool)
      : request_(request), volume_(volume), pool_(pool) {}

  Result<void> build() {
    SPLATLAS_RETURN_IF_ERROR(find_sources());
    if (volume_.sources_.empty() || request_.runs.count() == 0) {
      volume_.sources_.clear();
      return {};
    }
    SPLATLAS_RETURN_IF_ERROR(place_box());
    BrickMask any(volume_.grid_);
    for (Source& source : volume_.sources_) {
      SPLATLAS_RETURN_IF_ERROR(allocate(source));
      BrickMask mask(volume_.grid_);
      if (source.transfer) {
        fill_greys(source);
        mark_greys(source, mask);
        if (source.many_colors) fill_colors(source);
      } else {
        fill_optics(source, mask);
      }
      for (std::size_t n = 0; n < any.bricks.size(); ++n) any.bricks[n] |= mask.bricks[n];
      source.active = brick_sums(mask);
      for (const LitBlocks& slice : source.lit) volume_.lit_blocks_ += slice.size();
    }
    volume_.active_ = brick_sums(any);
    for (const Source& source : volume_.sources_) volume_.views_.push_back(view_of_source(source));
    request_.runs.for_each([&](const ClassRun& run, std::uint32_t) { volume_.voxels_ += run.length; });
    return {};
  }

 private:
  [[nodiscard]] MarchSource view_of_source(const Source& source) const {
    MarchSource view;
    const std::byte* values = source.values.data();
    if (!source.transfer && !request_.walked) {
      view.optics = reinterpret_cast<const float*>(values);
    } else if (source.scale.bytes) {
      view.cell_corners = reinterpret_cast<const std::uint64_t*>(values);
    } else {
      view.greys = reinterpret_cast<const float*>(values);
    }
    view.transfer = source.transfer.get();
    view.color = source.color;
    if (source.many_colors) view.colors = reinterpret_cast<const float*>(source.colors.data());
    view.active = source.active.data();
    return view;
  }

  /// Classes with equal transfer functions share a source.
  Result<void> find_sources() {
    const std::vector<ClassDraw>& classes = request_.plan.classes;
    constexpr std::size_t kUnknown = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> source_of(request_.selection.structures.size(), kUnknown);
    std::vector<TransferCurve> curves;
    for (std::size_t n = 0; n < classes.size(); ++n) {
      if (!draws_volume(classes[n].role)) continue;
      std::size_t& number = source_of[classes[n].volume_of];
      if (number == kUnknown) number = source_of_structure(classes[n].volume_of, curves);
      if (volume_.sources_.size() > kMaxSources) {
        return fail(ErrorCode::kLimit,
                    "the selection has more than {} different transfer functions, too many "
                    "to be classified after interpolation",
                    kMaxSources);
      }
      Source& source = volume_.sources_[number];
      const bool first = std::none_of(source.draws.begin(), source.draws.end(), [](bool d) { return d; });
      source.draws[n] = true;
      if (first) source.color = request_.appearances[n].color;
      source.many_colors = source.many_colors || source.color != request_.appearances[n].color ||
                           (request_.shade && (classes[n].boundary || request_.cache.values() != nullptr));
    }
    return {};
  }

  std::size_t source_of_structure(StructureIndex structure, std::vector<TransferCurve>& curves) {
    TransferCurve curve;  // without points: pre-classified
    std::optional<GreyScale> scale;
    if (request_.classification == Classification::kAfter) {
      curve = transfer_curve(request_.selection.structures[structure], request_.atlas.display());
      scale = grey_scale(curve, request_.atlas.value_type());
      if (!scale) curve.points.clear();
    }
    const auto known = std::find(curves.begin(), curves.end(), curve);
    if (known != curves.end()) return static_cast<std::size_t>(known - curves.begin());
    Source& source = volume_.sources_.emplace_back();
    source.draws.resize(request_.plan.classes.size(), false);
    if (scale) {
      source.scale = *scale;
      source.transfer =
          std::make_unique<PreintegratedTransfer>(curve, *scale, request_.atlas.reference_length_mm());
    }
    curves.push_back(std::move(curve));
    return curves.size() - 1;
  }

  Result<void> place_box() {
    const SelectedRuns& runs = request_.runs;
    const Index3& first = runs.box().first;
    const Index3 size{runs.scan_voxels(), runs.rows(), runs.slices()};
    std::uint64_t voxels = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      volume_.first_[a] = first[a] - kMargin;
      volume_.grid_.size[a] = static_cast<std::int32_t>(size[a] + 2 * kMargin);
      voxels *= static_cast<std::uint64_t>(volume_.grid_.size[a]);
      if (voxels > std::numeric_limits<std::int32_t>::max()) {
        return fail(ErrorCode::kLimit,
                    "the box around the selection has more than 2^31 voxels, too many for rays; select less");
      }
    }
    check_memory(bytes_of_ray_volume(volume_.grid_, runs.count()));
    volume_.bytes_ = bytes_needed(voxels);
    if (const std::uint64_t bytes = volume_.bytes_; bytes > request_.max_memory_bytes) {
      return fail(ErrorCode::kLimit,
                  "the selection's grey values take up to {} MiB for rays; {} MiB are "
                  "allowed. Select less, or raise --memory",
                  bytes >> 20, request_.max_memory_bytes >> 20);
    }
    return {};
  }

  /// Memory of the box, or of the pages that the runs touch if that is less.
  [[nodiscard]] std::uint64_t bytes_needed(std::uint64_t box_voxels) const {
    std::uint64_t bytes = 0;
    for (const Source& source : volume_.sources_) {
      const auto of = [&](std::uint64_t voxel_bytes, std::uint64_t rows) {
        std::uint64_t touched = 0;
        request_.runs.for_each([&](const ClassRun& run, std::uint32_t draw) {
          if (source.draws[draw]) touched += rows * ((run.length + 1) * voxel_bytes + 2 * kPageBytes);
        });
        return std::min(box_voxels * voxel_bytes, touched);
      };
      bytes += of(value_bytes(source), source.transfer && source.scale.bytes ? 4 : 1);
      if (color_bytes(source) > 0) bytes += of(color_bytes(source), 1);
    }
    return bytes;
  }

  [[nodiscard]] std::uint64_t value_bytes(const Source& source) const {
    if (!source.transfer) return volume_.voxel_floats_ * sizeof(float);
    return source.scale.bytes ? sizeof(std::uint64_t) : sizeof(float);
  }
  static std::uint64_t color_bytes(const Source& source) {
    return source.transfer && source.many_colors ? kFour * sizeof(float) : 0;
  }

  /// True if large pages waste little memory: sources fill a good part of the box on average, and the whole
  /// box is within the memory limit.
  [[nodiscard]] bool fills_box(std::uint64_t box_voxels) const {
    constexpr std::uint64_t kSparse = 32;
    const std::uint64_t selected = request_.plan.volume_voxels + request_.plan.hybrid_voxels;
    std::uint64_t voxel_bytes = 0;
    for (const Source& source : volume_.sources_) voxel_bytes += value_bytes(source) + color_bytes(source);
    return selected * kSparse >= box_voxels * volume_.sources_.size() &&
           box_voxels * voxel_bytes <= request_.max_memory_bytes;
  }

  Result<void> allocate(Source& source) {
    const auto& size = volume_.grid_.size;
    const std::size_t voxels = volume_.place(0, 0, size[2]);
    SPLATLAS_ASSIGN_OR_RETURN(source.values, SparseBytes::reserve(voxels * value_bytes(source)));
    if (color_bytes(source) > 0) {
      SPLATLAS_ASSIGN_OR_RETURN(source.colors, SparseBytes::reserve(voxels * color_bytes(source)));
    }
    if (fills_box(voxels)) {
      source.values.expect_dense();
      source.colors.expect_dense();
    }
    source.lit.resize(static_cast<std::size_t>(size[2]));
    return {};
  }

  /// A run of voxels of a source: position in the box, and memory offset of its first voxel in the grid.
  struct Piece {
    std::int64_t x = 0, y = 0, length = 0;
    std::size_t voxel = 0;
    std::uint32_t draw = 0;
  };
  /// Calls take(piece) for the runs of `source` in slice `z` of the box.
  template <typename Take>
  void for_each_piece(const Source& source, std::int64_t z, const Take& take) const {
    const std::int64_t slice = z + volume_.first_[2];
    const Grid& grid = request_.grid();
    request_.runs.for_each(slice, [&](const ClassRun& run, std::uint32_t draw) {
      if (!source.draws[draw]) return;
      take(Piece{run.start - volume_.first_[0], run.row - volume_.first_[1], run.length,
                 static_cast<std::size_t>(grid.offset(run.start, run.row, slice)), draw});
    });
  }

  /// Function from a voxel to its grey value as the source stores it. NaN maps to the lowest point of the
  /// transfer function, infinity to one width beyond its last point.
  template <typename T>
  auto stored_greys(const Source& source) const {
    const std::byte* values = request_.cache.values();
    const GreyScale scale = source.scale;
    const float* greys = source.transfer->row(PreintegratedTransfer::kGrey);
    const double lowest = greys[1], highest = greys[source.transfer->points()];
    const double width = highest - lowest;
    return [values, scale, lowest, highest, width](std::size_t voxel) {
      T value;
      std::memcpy(&value, values + voxel * sizeof(T), sizeof(T));
      const auto grey = static_cast<double>(value);
      if (std::isnan(grey)) return static_cast<float>(lowest);
      if (std::isinf(grey)) return static_cast<float>(grey > 0 ? highest + width : lowest - width);
      return static_cast<float>(std::clamp(scale.stored(grey), -kLargestStored, kLargestStored));
    };
  }

  void fill_greys(Source& source) {
    const auto slices = static_cast<std::size_t>(volume_.grid_.size[2]);
    if (source.scale.bytes) {
      pool_.for_each(slices - 1,
                     [&](std::size_t z) { fill_cell_corners(source, static_cast<std::int64_t>(z)); });
      return;
    }
    auto* greys = reinterpret_cast<float*>(source.values.data());
    visit_voxel_type(request_.atlas.value_type(), [&](auto tag) {
      const auto stored = stored_greys<decltype(tag)>(source);
      pool_.for_each(slices, [&](std::size_t z) {
        for_each_piece(source, static_cast<std::int64_t>(z), [&](const Piece& piece) {
          float* row = greys + volume_.place(piece.x, piece.y, static_cast<std::int64_t>(z));
          for (std::int64_t n = 0; n < piece.length; ++n)
            row[n] = stored(piece.voxel + static_cast<std::size_t>(n));
        });
      });
    });
  }

  /// Fills the cells between slices z and z + 1. Every voxel is a corner of four of them.
  void fill_cell_corners(Source& source, std::int64_t z) {
    auto* cell_corners = reinterpret_cast<std::uint8_t*>(source.values.data());
    const auto* greys = reinterpret_cast<const std::uint8_t*>(request_.cache.values());
    for (const std::int64_t behind : {0, 1}) {
      for_each_piece(source, z + behind, [&](const Piece& piece) {
        for (const std::int64_t below : {0, 1}) {
          std::uint8_t* cell =
              cell_corners + 8 * volume_.place(piece.x, piece.y - below, z) + 4 * behind + 2 * below;
          const std::uint8_t* grey = greys + piece.voxel;
          for (std::int64_t n = 0; n < piece.length; ++n) {
            cell[8 * n] = grey[n];
            cell[8 * n - 7] = grey[n];  // also the right corner of the previous cell
          }
        }
      });
    }
  }

  void mark_greys(const Source& source, BrickMask& mask) {
    visit_voxel_type(request_.atlas.value_type(), [&](auto tag) {
      const auto stored = stored_greys<decltype(tag)>(source);
      pool_.for_each(static_cast<std::size_t>(mask.z), [&](std::size_t brick_slice) {
        BrickRanges ranges(volume_.grid_);
        const auto first = static_cast<std::int64_t>(brick_slice) * MarchGrid::kBrick;
        for (std::int64_t z = first; z <= first + MarchGrid::kBrick; ++z) {
          for_each_piece(source, z, [&](const Piece& piece) {
            ranges.include(piece.x, piece.y, piece.length,
                           [&](std::int64_t n) { return stored(piece.voxel + static_cast<std::size_t>(n)); });
          });
        }
        const std::size_t bricks = mask.of_slice();
        for (std::size_t n = 0; n < bricks; ++n) {
          float low = 0, high = 0;
          const bool shows = ranges.range(n, low, high) && source.transfer->shows(low, high);
          mask.bricks[brick_slice * bricks + n] = shows ? 1 : 0;
        }
      });
    });
  }

  void fill_colors(Source& source) {
    auto* colors = reinterpret_cast<float*>(source.colors.data());
    pool_.for_each(source.lit.size(), [&](std::size_t slice) {
      const auto z = static_cast<std::int64_t>(slice);
      for_each_piece(source, z, [&](const Piece& piece) {
        const std::array<float, 3>& color = request_.appearances[piece.draw].color;
        const std::size_t first = kFour * volume_.place(piece.x, piece.y, z);
        for (std::int64_t n = 0; n < piece.length; ++n) {
          const std::size_t at = first + kFour * static_cast<std::size_t>(n);
          std::copy(color.begin(), color.end(), colors + at);
          colors[at + 3] = 1;
        }
        list_lit(source, piece, z, [](std::uint32_t) { return 1.0f; });
      });
    });
  }

  void fill_optics(Source& source, BrickMask& mask) {
    auto* optics = reinterpret_cast<float*>(source.values.data());
    const auto slices = static_cast<std::size_t>(volume_.grid_.size[2]);
    std::vector<std::vector<std::uint8_t>> visible(slices);  // [slice of voxels][brick]
    pool_.for_each(slices, [&](std::size_t slice) {
      const auto z = static_cast<std::int64_t>(slice);
      std::vector<std::uint8_t>& seen = visible[slice];
      seen.resize(mask.of_slice(), 0);
      std::vector<ClassifiedVoxel> voxels;
      for_each_piece(source, z, [&](const Piece& piece) {
        const VolumeAppearance& appearance = request_.appearances[piece.draw];
        voxels.resize(static_cast<std::size_t>(piece.length));
        appearance.look_up(request_.cache.values(), piece.voxel, 1, voxels.size(), voxels.data());
        const std::size_t first = volume_.voxel_floats_ * volume_.place(piece.x, piece.y, z);
        for (std::int64_t n = 0; n < piece.length; ++n) {
          const auto number = static_cast<std::size_t>(n);
          ClassifiedVoxel& voxel = voxels[number];
          voxel.extinction_per_mm *= request_.share(piece.voxel + number);
          if (voxel.extinction_per_mm <= 0) continue;
          const std::size_t at = first + volume_.voxel_floats_ * number;
          const std::array<float, 3> emission = appearance.emission(voxel);
          optics[at] = voxel.extinction_per_mm;
          if (!request_.walked) std::copy(emission.begin(), emission.end(), optics + at + 1);
          mark_around(mask, seen, piece.x + n, piece.y);
        }
        list_lit(source, piece, z,
                 [&](std::uint32_t n) { return voxels[n].extinction_per_mm * voxels[n].shade; });
      });
    });
    mark_slices(mask, visible);
  }

  /// Lists the lit voxels of a piece, block by block. `white(n)`: unlit emission of white of voxel n.
  template <typename White>
  void list_lit(Source& source, const Piece& piece, std::int64_t z, const White& white) const {
    const VoxelLight* lights =
        request_.shade ? request_.cache.light(piece.voxel, request_.plan.classes[piece.draw].boundary)
                       : nullptr;
    if (lights == nullptr) return;
    const std::uint32_t number = volume_.number(piece.x, piece.y);
    const auto count = static_cast<std::uint32_t>(piece.length);
    for (std::uint32_t n = 0, end = 0; n < count; n = end) {
      const std::uint32_t lane = (number + n) % kBlock;
      end = std::min(count, n + static_cast<std::uint32_t>(kBlock) - lane);
      const std::span<const VoxelLight> of_block(lights + n, end - n);
      if (std::ranges::none_of(of_block, [](const VoxelLight& light) { return light.lit > 0; })) continue;
      LitBlock& block = require_block(source.lit[static_cast<std::size_t>(z)], (number + n) >> kBlockBits,
                                      request_.appearances[piece.draw].color);
      for (std::uint32_t k = n; k < end; ++k) {
        const float of_voxel = white(k);
        if (of_voxel <= 0) continue;
        block.whites[lane + k - n] = of_voxel;
        block.lights[lane + k - n] = lights[k];
      }
    }
  }

  const RayVolumeRequest& request_;
  RayVolume& volume_;
  ThreadPool& pool_;
};

Result<RayVolume> RayVolume::build(const RayVolumeRequest& request, ThreadPool& pool) {
  RayVolume volume;
  volume.runs_ = request.runs.count();
  volume.classification_ = request.classification;
  volume.shade_ = request.shade;
  if (request.walked) volume.voxel_floats_ = 1;
  SPLATLAS_RETURN_IF_ERROR(Builder(request, volume, pool).build());
  return volume;
}

}  // namespace splatlas
