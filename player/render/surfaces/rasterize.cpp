#include "player/render/surfaces/rasterize.h"

#include <algorithm>
#include <atomic>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "player/render/simd/simd_choice.h"

namespace splatlas {
namespace {

std::uint64_t triangles_of(const RasterScene& scene) {
  std::uint64_t triangles = 0;
  for (const SurfaceDraw& surface : scene.surfaces) triangles += surface.mesh->triangles.size();
  return triangles;
}

/// Its memory is kept for the next tile: page faults would cost more than the tile.
TileRasterizer& worker_of_thread() {
  static thread_local TileRasterizer worker;
  return worker;
}

/// Summarises the faces of the pixels of row y from column x_first on.
void see_faces(const RasterScene& scene, std::int32_t x_first, std::int32_t y, float termination_threshold,
               std::span<SurfacesSeen> row) {
  std::fill(row.begin(), row.end(), SurfacesSeen{});
  if (scene.faces == nullptr) return;
  const auto [first, last] = scene.faces->shown[static_cast<std::size_t>(y)];
  const std::int32_t x_end = x_first + static_cast<std::int32_t>(row.size());
  for (std::int32_t x = std::max(first, x_first); x < std::min(last, x_end); ++x) {
    SurfacesSeen& seen = row[static_cast<std::size_t>(x - x_first)];
    const RayFaces faces = scene.faces->at(scene.size.pixel(x, y));
    seen.add(faces.front, 1);
    const float transmittance = 1 - faces.front.rgba[3];
    if (transmittance > termination_threshold) seen.add(faces.back, transmittance);
  }
}

}  // namespace

SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& appearance, const SurfaceMesh& mesh,
                         const SurfaceClusters& clusters) {
  return {&mesh,
          &clusters,
          s,
          {srgb_to_linear(appearance.color.r), srgb_to_linear(appearance.color.g),
           srgb_to_linear(appearance.color.b)},
          appearance.opacity.value_or(appearance.ghost ? kGhostOpacity : 1.0f),
          appearance.ghost ? std::optional(appearance.term) : std::nullopt};
}

/// Number of fragments that are kept so far. The limit applies to the sum over all tiles, so that their order
/// is irrelevant, and to the crossings of each tile.
struct Rasterizer::Count {
  std::size_t limit = 0;
  std::atomic<std::size_t> total{0};
  std::atomic<bool> too_many{false};

  void add(std::size_t more) {
    if (total += more; total > limit) too_many = true;
  }
};

Result<std::uint64_t> Rasterizer::draw(const RasterScene& scene, const RasterOptions& options,
                                       FragmentList& out, ThreadPool& pool) {
  const std::uint64_t triangles = triangles_of(scene);
  out.clear(scene.size);
  if (triangles == 0 && (scene.faces == nullptr || options.edge_samples == 1)) return triangles;
  // Edges need the neighbours of the region's pixels
  RasterScene with_neighbours = scene;
  if (options.edge_samples > 1)
    with_neighbours.region = intersection(scene.region.grown(1), PixelBox::of(scene.size));
  if (triangles == 0) with_neighbours.region = scene.faces->around_faces(with_neighbours.region);
  if (with_neighbours.region.empty()) return triangles;
  SPLATLAS_RETURN_IF_ERROR(draw_tiles(with_neighbours, options, nullptr, pool));
  merge_tiles(scene, with_neighbours.region, out, pool);
  return triangles;
}

Result<std::uint64_t> Rasterizer::paint(const RasterScene& scene, const RasterOptions& options,
                                        Picture& picture, std::vector<float>* depths, ThreadPool& pool) {
  picture.size = scene.size;
  picture.rgba.resize(4 * scene.region.pixels());
  if (depths != nullptr) depths->resize(scene.region.pixels());
  const PaintTile paint = [&](TileRasterizer& tile) { tile.paint(picture.rgba, depths); };
  SPLATLAS_RETURN_IF_ERROR(draw_tiles(scene, options, &paint, pool));
  return triangles_of(scene);
}

Result<void> Rasterizer::draw_tiles(const RasterScene& scene, const RasterOptions& options,
                                    const PaintTile* paint, ThreadPool& pool) {
  static_cast<void>(best_target());  // applies SPLATLAS_SIMD
  Count count{options.max_fragments};
  bins_.fill(scene, pool);

  // Draw the centres of all pixels
  centers_.resize(bins_.tiles());
  const bool has_surfaces = triangles_of(scene) > 0;
  seen_.resize(has_surfaces && options.edge_samples > 1 ? scene.region.pixels() : 0);
  const auto has_faces_alone = [&](std::size_t n) { return paint == nullptr && bins_.of_tile(n).empty(); };
  pool.for_each(centers_.size(), [&](std::size_t n) {
    centers_[n].fragments.clear();
    if (has_faces_alone(n)) {
      check_task();
      const PixelBox box = bins_.box(n);
      for (std::int32_t y = box.y_first; y <= box.y_last && !seen_.empty(); ++y)
        see_faces(scene, box.x_first, y, options.termination_threshold,
                  {&seen_[scene.region.place(box.x_first, y)], static_cast<std::size_t>(box.width())});
      return;
    }
    TileRasterizer& worker = worker_of_thread();
    worker.begin(scene, bins_.box(n),
                 {options.termination_threshold, paint == nullptr, bins_.of_tile(n).empty(), seen_});
    draw_and_finish(n, worker, paint, centers_[n], count);
  });

  // Draw the samples of pixels at edges
  edges_.resize(options.edge_samples > 1 ? bins_.tiles() : 0);
  if (!edges_.empty() && !count.too_many) {
    pattern_ = sample_pattern(options.edge_samples);
    const PictureSize size{scene.region.width(), scene.region.height()};
    const SeenRow seen = [&](std::int32_t row, std::vector<SurfacesSeen>& room) -> const SurfacesSeen* {
      if (has_surfaces) return &seen_[size.pixel(0, row)];
      room.resize(static_cast<std::size_t>(size.width));
      see_faces(scene, scene.region.x_first, scene.region.y_first + row, options.termination_threshold, room);
      return room.data();
    };
    find_edge_pixels(seen, size, scene.pixel_voxels, is_edge_, pool);
    if (paint == nullptr)
      count.add(pattern_.size() * static_cast<std::size_t>(std::ranges::count(is_edge_, 1)));
    pool.for_each(edges_.size(), [&](std::size_t n) {
      edges_[n].fragments.clear();
      if (has_faces_alone(n)) return;
      TileRasterizer& worker = worker_of_thread();
      worker.begin_edges(scene, bins_.box(n), is_edge_, pattern_,
                         {options.termination_threshold, paint == nullptr});
      draw_and_finish(n, worker, paint, edges_[n], count);
    });
  }
  if (!count.too_many) return {};
  return fail(ErrorCode::kLimit,
              "the surfaces leave more than {} fragments at one place, too many for the memory allowed; "
              "select fewer translucent surfaces, or raise --memory",
              options.max_fragments);
}

void Rasterizer::draw_and_finish(std::size_t tile, TileRasterizer& worker, const PaintTile* paint,
                                 TileFragments& out, Count& count) const {
  for (const TileCluster& of : bins_.of_tile(tile)) {
    check_task();
    if (worker.held() > count.limit) count.too_many = true;
    if (count.too_many.load(std::memory_order_relaxed)) return;
    worker.draw(of);
  }
  if (paint != nullptr) return (*paint)(worker);
  worker.finish(out);
  count.add(out.fragments.size());
}

template <typename Visit>
void Rasterizer::for_each_sample(std::size_t tile_row, const RasterScene& scene, const PixelBox& drawn,
                                 const Visit& visit) const {
  const std::size_t first_tile = tile_row * bins_.columns();
  const PixelBox rows = bins_.box(first_tile);
  std::vector<std::size_t> edge_slots(bins_.columns());  // next slot of each tile
  for (std::int32_t y = rows.y_first; y <= rows.y_last; ++y) {
    for (std::size_t column = 0; column < bins_.columns(); ++column) {
      const std::size_t tile = first_tile + column;
      const PixelBox box = bins_.box(tile);
      auto slot = static_cast<std::size_t>(y - box.y_first) * TileRasterizer::kStride;
      for (std::int32_t x = box.x_first; x <= box.x_last; ++x, ++slot) {
        const bool is_inside = scene.region.contains(x, y);
        const std::size_t pixel = scene.size.pixel(x, y);
        if (edges_.empty() || is_edge_[drawn.place(x, y)] == 0) {
          const std::span<const Fragment> fragments = centers_[tile].of_slot(slot);
          if (is_inside && !fragments.empty()) visit(pixel, SubPixel{}, fragments);
          continue;
        }
        for (const SubPixel& place : pattern_) {
          const std::size_t of_edge = edge_slots[column]++;
          if (is_inside) visit(pixel, place, edges_[tile].of_slot(of_edge));
        }
      }
    }
  }
}

/// Concatenates the samples and fragments of all tiles.
void Rasterizer::merge_tiles(const RasterScene& scene, const PixelBox& drawn, FragmentList& out,
                             ThreadPool& pool) const {
  // Count samples and fragments of each row of tiles, and compute prefix sums
  struct Begin {
    std::size_t sample = 0, fragment = 0;
  };
  std::vector<Begin> begin(bins_.rows() + 1);
  pool.for_each(bins_.rows(), [&](std::size_t n) {
    Begin sum;
    for_each_sample(n, scene, drawn, [&](std::size_t, const SubPixel&, std::span<const Fragment> fragments) {
      ++sum.sample;
      sum.fragment += fragments.size();
    });
    begin[n + 1] = sum;
  });
  for (std::size_t n = 0; n < bins_.rows(); ++n) {
    begin[n + 1].sample += begin[n].sample;
    begin[n + 1].fragment += begin[n].fragment;
  }
  out.samples.resize(begin.back().sample + 1);
  out.samples.back() = {0, static_cast<std::uint32_t>(begin.back().fragment), {}};
  out.fragments.resize(begin.back().fragment);

  // Copy in parallel and set the offsets of picture rows
  const auto width = static_cast<std::size_t>(scene.size.width);
  pool.for_each(bins_.rows(), [&](std::size_t n) {
    std::size_t sample = begin[n].sample, fragment = begin[n].fragment;
    const PixelBox rows = bins_.box(n * bins_.columns());
    auto row = static_cast<std::size_t>(rows.y_first);  // next row without an offset
    for_each_sample(
        n, scene, drawn, [&](std::size_t pixel, const SubPixel& place, std::span<const Fragment> from) {
          for (; row <= pixel / width; ++row) out.first_of_row[row] = static_cast<std::uint32_t>(sample);
          out.samples[sample++] = {static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(fragment),
                                   place};
          std::copy(from.begin(), from.end(), out.fragments.begin() + static_cast<std::ptrdiff_t>(fragment));
          fragment += from.size();
        });
    for (; row <= static_cast<std::size_t>(rows.y_last); ++row)
      out.first_of_row[row] = static_cast<std::uint32_t>(sample);
  });
  std::fill(out.first_of_row.begin() + drawn.y_last + 1, out.first_of_row.end(),
            static_cast<std::uint32_t>(begin.back().sample));
}

}  // namespace splatlas
