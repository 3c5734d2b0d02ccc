#include "player/web/page_slices.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "format/result_macros.h"

namespace splatlas {

PageSlices::PageSlices(std::shared_ptr<const Atlas> atlas)
    : atlas_(std::move(atlas)), decoded_(atlas_->classes().size()) {}

Result<void> PageSlices::decode(ClassId c) {
  const Grid& grid = atlas_->grid();
  labels_.resize(static_cast<std::size_t>(grid.voxels()));
  greys_.resize(labels_.size());
  SPLATLAS_ASSIGN_OR_RETURN(const ClassRuns runs, atlas_->read_runs(c, Axis::kZ));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> values, atlas_->read_values(c));
  std::uint16_t label = 0;  // of the last structure that holds the voxels
  for (const Membership& member : atlas_->classes().members(c)) {
    if (member.holds() && member.structure < 0xffff) label = static_cast<std::uint16_t>(member.structure + 1);
  }
  const double low = atlas_->display().window_low, high = atlas_->display().window_high;
  visit_voxel_type(atlas_->value_type(), [&](auto tag) {
    const auto* value = reinterpret_cast<const decltype(tag)*>(values.data());
    for (const Run& run : runs) {
      const std::size_t first = run.scanline * static_cast<std::size_t>(grid.size[0]) + run.start;
      std::fill_n(labels_.begin() + static_cast<std::ptrdiff_t>(first), run.length, label);
      for (std::size_t n = first; !values.empty() && n < first + run.length; ++n, ++value) {
        const double position = (static_cast<double>(*value) - low) / (high > low ? high - low : 1);
        greys_[n] = static_cast<std::uint8_t>(position > 0 ? std::lround(255 * std::min(position, 1.0)) : 0);
      }
    }
  });
  decoded_[c] = true;
  return {};
}

Result<nlohmann::ordered_json> PageSlices::slice(int axis, std::int64_t index) {
  const Index3& size = atlas_->grid().size;
  const auto a = static_cast<std::size_t>(axis);
  if (a >= 3 || index < 0 || index >= size[a])
    return fail(ErrorCode::kNotFound, "slice {} across axis {}: none", index, axis);
  for (ClassId c = 1; c < decoded_.size(); ++c) {
    const IndexBox& box = atlas_->classes().box(c);
    if (!decoded_[c] && box.first[a] <= index && index <= box.last[a]) SPLATLAS_RETURN_IF_ERROR(decode(c));
  }

  // Walk through the slice
  constexpr const char* kDigits = "0123456789abcdef";
  const std::int64_t steps[] = {1, size[0], size[0] * size[1]};
  const std::size_t along = a == 0 ? 1 : 0, across = a == 2 ? 1 : 2;
  std::vector<std::int64_t> runs;
  std::string greys;
  for (std::int64_t row = 0; row < size[across]; ++row) {
    for (std::int64_t column = 0; column < size[along]; ++column) {
      const auto n = static_cast<std::size_t>(index * steps[a] + row * steps[across] + column * steps[along]);
      const std::int64_t label = labels_.empty() ? 0 : labels_[n];
      const std::uint8_t grey = greys_.empty() ? 0 : greys_[n];
      if (runs.empty() || runs[runs.size() - 2] != label) runs.insert(runs.end(), {label, 0});
      ++runs.back();
      greys += {kDigits[grey >> 4], kDigits[grey & 15]};
    }
  }
  return nlohmann::ordered_json{{"labels", runs}, {"greys", greys}};
}

}  // namespace splatlas
