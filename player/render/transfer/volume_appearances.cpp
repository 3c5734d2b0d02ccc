#include "player/render/transfer/volume_appearances.h"

#include <algorithm>
#include <limits>

#include "player/transfer_function.h"

namespace splatlas {
namespace {

/// Further transfer functions are evaluated voxel by voxel: their tables would cost more than they save
/// (16 MiB in all for values of 16 bits).
constexpr std::size_t kMaxTables = 32;

}  // namespace

VolumeAppearances::VolumeAppearances(const Atlas& atlas)
    : type_(atlas.value_type()),
      display_(atlas.display()),
      reference_length_mm_(atlas.reference_length_mm()),
      plain_(&table_of(shape_of(transfer_curve({}, display_)))) {}

const TransferTable& VolumeAppearances::table_of(const TransferShape& shape) {
  return tables_.try_emplace(shape, shape, type_, tables_.size() < kMaxTables).first->second;
}

VolumeAppearance VolumeAppearances::appearance_of(const StructureDraw& draw) {
  VolumeAppearance appearance;
  appearance.color = {srgb_to_linear(draw.color.r), srgb_to_linear(draw.color.g),
                      srgb_to_linear(draw.color.b)};
  appearance.extinction_per_mm = static_cast<float>(extinction_of(full_opacity(draw), reference_length_mm_));
  appearance.transfer =
      draw.volume == VolumeStyle{} ? plain_ : &table_of(shape_of(transfer_curve(draw, display_)));
  return appearance;
}

void VolumeAppearances::select(const DrawPlan& plan, const Selection& selection) {
  if (tables_.size() >= kMaxTables) {
    plain_ = nullptr;
    tables_.clear();
    ++generation_;
  }
  if (plain_ == nullptr) plain_ = &table_of(shape_of(transfer_curve({}, display_)));
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> first_class(selection.structures.size(), kNone);  // of each structure
  appearances_.assign(plan.classes.size(), {});
  for (std::size_t n = 0; n < appearances_.size(); ++n) {
    const ClassDraw& draw = plan.classes[n];
    if (!draws_volume(draw.role)) continue;
    std::size_t& first = first_class[draw.volume_of];
    appearances_[n] =
        first == kNone ? appearance_of(selection.structures[draw.volume_of]) : appearances_[first];
    first = std::min(first, n);
  }
}

}  // namespace splatlas
