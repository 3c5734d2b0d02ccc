// Inputs of spans and of ray volumes.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "player/render/light/voxel_light.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render/sheets/spans/build_spans.h"
#include "tests/support/test_content.h"

namespace splatlas {

/// A selection of a test atlas, up to its spans and ray volume.
struct PreparedSelection {
  std::shared_ptr<const Atlas> atlas;
  Selection selection;
  DrawPlan plan;
  VolumeAppearances appearances;
  ThreadPool pool;
  ClassCache cache;

  PreparedSelection(const AtlasContent& content, const Selection& selected, unsigned threads = 1)
      : atlas(open_in_memory(content)), appearances(*atlas), pool(threads), cache(atlas) {
    select(selected);
  }

  void select(const Selection& selected) {
    selection = selected;
    plan = atlas->tree().plan(selection);
    appearances.select(plan, selection);
  }
  SelectedRuns runs(Axis axis) {
    for (const ClassDraw& draw : plan.classes) {
      if (draw.boundary) cache.forget_lost_normals(draw.id, draw.volume_of);
    }
    EXPECT_TRUE(cache.require(volume_classes(plan), axis, pool));
    light_voxels(plan, appearances, atlas->classes(), atlas->grid(), cache, pool);
    return {plan, atlas->classes(), cache, axis};
  }
  void build(Axis axis, SpanBuilder& builder, bool shade = true) {
    const SelectedRuns of_axis = runs(axis);
    builder.build({of_axis, plan, appearances, atlas->classes(), atlas->grid(), cache, shade}, pool);
  }
  SpanModel spans(Axis axis, bool shade = true) {
    SpanBuilder builder;
    build(axis, builder, shade);
    return std::move(builder.model());
  }
  RayVolume rays(Classification classification, bool shade = false) {
    const SelectedRuns of_z = runs(Axis::kZ);
    return RayVolume::build({.atlas = *atlas,
                             .selection = selection,
                             .plan = plan,
                             .appearances = appearances.appearances(),
                             .runs = of_z,
                             .cache = cache,
                             .classification = classification,
                             .shade = shade,
                             .max_memory_bytes = std::uint64_t{1} << 30},
                            pool)
        .value();
  }
};

}  // namespace splatlas
