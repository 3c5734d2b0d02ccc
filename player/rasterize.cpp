#include "player/rasterize.h"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

namespace splatlas {

SurfaceDraw surface_draw(StructureIndex s, const StructureDraw& look, const SurfaceMesh& mesh) {
  return {&mesh,
          s,
          {srgb_to_linear(look.color.r), srgb_to_linear(look.color.g), srgb_to_linear(look.color.b)},
          look.opacity.value_or(1.0f)};
}

Result<RasterCounters> Rasterizer::draw(const RasterScene& scene, const RasterOptions& options,
                                        FragmentList& out, ThreadPool& pool) {
  RasterCounters counters;
  for (const SurfaceDraw& surface : scene.surfaces) counters.triangles += surface.mesh->triangles.size();
  out.fragments.clear();
  out.samples.assign(1, Sample{});
  out.first_of_row.assign(static_cast<std::size_t>(scene.size.height) + 1, 0);
  if (counters.triangles == 0) return counters;

  bins_.fill(scene.surfaces, scene.projection, scene.size, pool);
  bands_.resize(bins_.bands());
  std::atomic<std::size_t> total{0};
  std::atomic<bool> too_many{false};
  pool.for_each(bands_.size(), [&](std::size_t n) {
    const int first_row = static_cast<int>(n) * TriangleBins::kBandRows;
    BandRasterizer& band = bands_[n];
    band.begin(scene, bins_, first_row, std::min(first_row + TriangleBins::kBandRows, scene.size.height));
    for (const bool opaque : {true, false}) {
      bins_.for_each(n, opaque, [&](const TriangleRef& ref) {
        if (band.crossings() > options.max_fragments) too_many = true;
        if (!too_many.load(std::memory_order_relaxed)) band.draw(ref);
      });
    }
    if (too_many) return;
    band.finish(options.transmittance_floor);
    if (total += band.crossings(); total > options.max_fragments) too_many = true;
  });
  if (too_many) {
    return fail(
        ErrorCode::kLimit,
        fmt::format(
            "the surfaces leave more than {} fragments in this picture; make it smaller or select fewer "
            "translucent surfaces",
            options.max_fragments));
  }
  merge_bands(scene, out, pool);
  return counters;
}

/// Every band's samples and fragments to their places in the picture's.
void Rasterizer::merge_bands(const RasterScene& scene, FragmentList& out, ThreadPool& pool) {
  struct Begin {
    std::size_t sample = 0, fragment = 0;
  };
  std::vector<Begin> begin(bands_.size() + 1);
  pool.for_each(bands_.size(), [&](std::size_t n) {
    const BandRasterizer& band = bands_[n];
    for (std::size_t slot = 0; slot < band.slots(); ++slot) {
      begin[n + 1].sample += band.fragments(slot) > 0 ? 1 : 0;
      begin[n + 1].fragment += band.fragments(slot);
    }
  });
  for (std::size_t n = 0; n < bands_.size(); ++n) {
    begin[n + 1].sample += begin[n].sample;
    begin[n + 1].fragment += begin[n].fragment;
  }
  out.samples.resize(begin.back().sample + 1);
  out.samples.back() = {0, static_cast<std::uint32_t>(begin.back().fragment)};
  out.fragments.resize(begin.back().fragment);

  const auto width = static_cast<std::size_t>(scene.size.width);
  pool.for_each(bands_.size(), [&](std::size_t n) {
    const BandRasterizer& band = bands_[n];
    auto [sample, fragment] = begin[n];
    const std::size_t first_pixel_of_band = n * TriangleBins::kBandRows * width;
    for (std::size_t slot = 0; slot < band.slots(); ++slot) {
      const std::size_t pixel = first_pixel_of_band + slot;
      if (pixel % width == 0) out.first_of_row[pixel / width] = static_cast<std::uint32_t>(sample);
      if (band.fragments(slot) == 0) continue;
      out.samples[sample++] = {static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(fragment)};
      band.store(slot, out.fragments.data() + fragment);
      fragment += band.fragments(slot);
    }
  });
  out.first_of_row.back() = static_cast<std::uint32_t>(begin.back().sample);
}

}  // namespace splatlas
