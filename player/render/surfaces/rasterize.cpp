#include "player/render/surfaces/rasterize.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "format/result_macros.h"
#include "player/render/surfaces/edge_pixels.h"

namespace splatlas {
namespace {

/// Picture rows [first, last) of a band.
std::pair<int, int> rows_of(std::size_t band, const RasterScene& scene) {
  const int first = static_cast<int>(band) * TriangleBins::kBandRows;
  return {first, std::min(first + TriangleBins::kBandRows, scene.size.height)};
}

}  // namespace

SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& appearance, const SurfaceMesh& mesh) {
  return {&mesh,
          s,
          {srgb_to_linear(appearance.color.r), srgb_to_linear(appearance.color.g),
           srgb_to_linear(appearance.color.b)},
          appearance.opacity.value_or(1.0f)};
}

/// Number of fragments so far. The limit applies to the sum over all bands, so that their order is
/// irrelevant.
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
  std::uint64_t triangles = 0;
  for (const SurfaceDraw& surface : scene.surfaces) triangles += surface.mesh->triangles.size();
  out.fragments.clear();
  out.samples.assign(1, Sample{});
  out.first_of_row.assign(static_cast<std::size_t>(scene.size.height) + 1, 0);
  if (triangles == 0 && (scene.faces == nullptr || options.edge_samples == 1)) return triangles;

  Count count{options.max_fragments};
  bins_.fill(scene.surfaces, scene.projection, scene.size, scene.cuts, pool);
  if (!draw_centers(scene, options, count, pool) || !draw_edges(scene, options, count, pool)) {
    return fail(ErrorCode::kLimit,
                "the surfaces leave more than {} fragments in this picture; make it smaller or select fewer "
                "translucent surfaces",
                options.max_fragments);
  }
  merge_bands(scene, out, pool);
  return triangles;
}

bool Rasterizer::draw_centers(const RasterScene& scene, const RasterOptions& options, Count& count,
                              ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(scene.size.width);
  const bool finds_edges = options.edge_samples > 1;
  centers_.resize(bins_.bands());
  seen_.resize(finds_edges ? width * static_cast<std::size_t>(scene.size.height) : 0);
  pool.for_each(centers_.size(), [&](std::size_t n) {
    const auto [first_row, last_row] = rows_of(n, scene);
    std::unique_ptr<BandRasterizer> worker = take_worker();
    worker->begin(scene, bins_, first_row, last_row);
    if (draw_band(n, *worker, count)) {
      std::span<SurfacesSeen> seen;
      if (finds_edges) {
        seen = std::span(seen_).subspan(static_cast<std::size_t>(first_row) * width, worker->slots());
      }
      SlotFaces faces;
      if (scene.faces != nullptr) {
        const std::size_t first = static_cast<std::size_t>(first_row) * width;
        faces.front = std::span(scene.faces->front).subspan(first, worker->slots());
        if (!scene.faces->back.empty())
          faces.back = std::span(scene.faces->back).subspan(first, worker->slots());
      }
      worker->finish(options.termination_threshold, centers_[n], seen, faces);
      count.add(worker->crossings());
    }
    give_back(std::move(worker));
  });
  return !count.too_many;
}

bool Rasterizer::draw_edges(const RasterScene& scene, const RasterOptions& options, Count& count,
                            ThreadPool& pool) {
  edges_.resize(options.edge_samples > 1 ? bins_.bands() : 0);
  if (edges_.empty()) return true;
  pattern_ = sample_pattern(options.edge_samples);
  find_edge_pixels(seen_, scene.size, scene.pixel_voxels, is_edge_, pool);
  bins_.refill(is_edge_, scene.size, pool);
  const auto width = static_cast<std::size_t>(scene.size.width);
  pool.for_each(edges_.size(), [&](std::size_t n) {
    const auto [first_row, last_row] = rows_of(n, scene);
    const auto wanted = std::span<const std::uint8_t>(is_edge_).subspan(
        static_cast<std::size_t>(first_row) * width, static_cast<std::size_t>(last_row - first_row) * width);
    std::unique_ptr<BandRasterizer> worker = take_worker();
    worker->begin_edges(scene, bins_, first_row, last_row, wanted, pattern_);
    count.add(worker->slots());
    if (draw_band(n, *worker, count)) {
      worker->finish(options.termination_threshold, edges_[n], {});
      count.add(worker->crossings());
    }
    give_back(std::move(worker));
  });
  return !count.too_many;
}

/// False if there are too many fragments.
bool Rasterizer::draw_band(std::size_t n, BandRasterizer& band, Count& count) const {
  for (const bool opaque : {true, false}) {
    bins_.for_each(n, opaque, [&](const TriangleRef& ref) {
      if (band.crossings() > count.limit) count.too_many = true;
      if (!count.too_many.load(std::memory_order_relaxed)) band.draw(ref);
    });
  }
  return !count.too_many;
}

std::unique_ptr<BandRasterizer> Rasterizer::take_worker() {
  const std::lock_guard lock(workers_->mutex);
  if (workers_->idle.empty()) return std::make_unique<BandRasterizer>();
  std::unique_ptr<BandRasterizer> worker = std::move(workers_->idle.back());
  workers_->idle.pop_back();
  return worker;
}

void Rasterizer::give_back(std::unique_ptr<BandRasterizer> worker) {
  const std::lock_guard lock(workers_->mutex);
  workers_->idle.push_back(std::move(worker));
}

template <typename Visit>
void Rasterizer::for_each_sample(std::size_t n, const RasterScene& scene, const Visit& visit) const {
  const std::size_t first_pixel = n * TriangleBins::kBandRows * static_cast<std::size_t>(scene.size.width);
  std::size_t edge_slot = 0;
  for (std::size_t slot = 0; slot < centers_[n].end_of_slot.size(); ++slot) {
    const std::size_t pixel = first_pixel + slot;
    if (edges_.empty() || is_edge_[pixel] == 0) {
      const std::span<const Fragment> fragments = centers_[n].of_slot(slot);
      if (!fragments.empty()) visit(pixel, SubPixel{}, fragments);
      continue;
    }
    for (const SubPixel& place : pattern_) visit(pixel, place, edges_[n].of_slot(edge_slot++));
  }
}

/// Concatenates the samples and fragments of all bands.
void Rasterizer::merge_bands(const RasterScene& scene, FragmentList& out, ThreadPool& pool) const {
  // Count samples and fragments of each band, and compute prefix sums
  struct Begin {
    std::size_t sample = 0, fragment = 0;
  };
  std::vector<Begin> begin(centers_.size() + 1);
  pool.for_each(centers_.size(), [&](std::size_t n) {
    for_each_sample(n, scene, [&](std::size_t, const SubPixel&, std::span<const Fragment> fragments) {
      ++begin[n + 1].sample;
      begin[n + 1].fragment += fragments.size();
    });
  });
  for (std::size_t n = 0; n < centers_.size(); ++n) {
    begin[n + 1].sample += begin[n].sample;
    begin[n + 1].fragment += begin[n].fragment;
  }
  out.samples.resize(begin.back().sample + 1);
  out.samples.back() = {0, static_cast<std::uint32_t>(begin.back().fragment), {}};
  out.fragments.resize(begin.back().fragment);

  // Copy in parallel and set the offsets of picture rows
  const auto width = static_cast<std::size_t>(scene.size.width);
  pool.for_each(centers_.size(), [&](std::size_t n) {
    std::size_t sample = begin[n].sample, fragment = begin[n].fragment;
    const auto rows = rows_of(n, scene);
    auto row = rows.first;  // next row without an offset
    for_each_sample(n, scene, [&](std::size_t pixel, const SubPixel& place, std::span<const Fragment> from) {
      for (; static_cast<std::size_t>(row) <= pixel / width; ++row) {
        out.first_of_row[static_cast<std::size_t>(row)] = static_cast<std::uint32_t>(sample);
      }
      out.samples[sample++] = {static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(fragment),
                               place};
      std::copy(from.begin(), from.end(), out.fragments.begin() + static_cast<std::ptrdiff_t>(fragment));
      fragment += from.size();
    });
    for (; row < rows.second; ++row) {
      out.first_of_row[static_cast<std::size_t>(row)] = static_cast<std::uint32_t>(sample);
    }
  });
  out.first_of_row.back() = static_cast<std::uint32_t>(begin.back().sample);
}

}  // namespace splatlas
