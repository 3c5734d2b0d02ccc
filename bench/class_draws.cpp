#include "bench/class_draws.h"

#include <array>
#include <map>
#include <tuple>

namespace splatlas {

std::vector<std::uint32_t> draws_by_class(const DrawPlan& plan, std::size_t classes) {
  std::vector<std::uint32_t> draws(classes, kNotDrawn);
  for (std::uint32_t n = 0; n < plan.classes.size(); ++n) {
    if (draws_volume(plan.classes[n].role)) draws[plan.classes[n].id] = n;
  }
  return draws;
}

std::vector<std::uint32_t> shared_draws_by_class(const DrawPlan& plan,
                                                 std::span<const VolumeAppearance> appearances,
                                                 std::size_t classes) {
  std::vector<std::uint32_t> draws = draws_by_class(plan, classes);
  std::map<std::tuple<std::array<float, 3>, float, const TransferTable*>, std::uint32_t> first;
  for (std::uint32_t& draw : draws) {
    if (draw == kNotDrawn) continue;
    const VolumeAppearance& appearance = appearances[draw];
    draw = first.try_emplace({appearance.color, appearance.extinction_per_mm, appearance.transfer}, draw)
               .first->second;
  }
  return draws;
}

}  // namespace splatlas
