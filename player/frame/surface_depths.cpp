#include "player/frame/surface_depths.h"

#include <algorithm>

namespace splatlas {

void add_surface_depths(const FragmentList& fragments, std::size_t depth_axis, double depth_sign,
                        const ViewDepth& view, DepthMap& depths) {
  const auto width = static_cast<std::uint32_t>(depths.size.width);
  for (std::size_t n = 0; n < fragments.sample_count(); ++n) {
    const Sample& sample = fragments.samples[n];
    float transmittance = 1;
    for (const Fragment& fragment : fragments.of_sample(n)) {
      transmittance *= 1 - fragment.rgba[3];
      if (transmittance > 0.5f) continue;
      const std::uint32_t column = sample.pixel % width, row = sample.pixel / width;
      const double x = column + static_cast<double>(sample.place.right());
      const double y = row + static_cast<double>(sample.place.down());
      const auto mm = static_cast<float>(view.mm(x, y, depth_axis, depth_sign * fragment.depth));
      depths.mm[sample.pixel] = std::min(depths.mm[sample.pixel], mm);
      break;
    }
  }
}

}  // namespace splatlas
