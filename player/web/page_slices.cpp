#include "player/web/page_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {

Result<void> PageSlices::decode(ClassId c) {
  // A server is asked for both at once
  Result<ClassRuns> runs = atlas_->read_runs(c, Axis::kZ);
  Result<std::vector<std::byte>> values = atlas_->read_values(c);
  if (!runs) return tl::unexpected(runs.error());
  if (!values) return tl::unexpected(values.error());
  classes_[c] = {*std::move(runs), *std::move(values)};
  return {};
}

void PageSlices::paint(ClassId c, std::size_t axis, std::int64_t index, Pixels& pixels) const {
  const Index3& size = atlas_->grid().size;
  const std::vector<std::byte>& values = classes_.at(c).values;
  const std::size_t along = axis == 0 ? 1 : 0, across = axis == 2 ? 1 : 2;
  std::uint16_t label = 0;  // of the last structure that holds the voxels
  for (const Membership& member : atlas_->classes().members(c)) {
    if (member.holds() && member.structure < 0xffff) label = static_cast<std::uint16_t>(member.structure + 1);
  }
  const double low = atlas_->display().window_low, high = atlas_->display().window_high;
  const auto scale = high > low ? 255 / (high - low) : 255;
  std::size_t value = 0;  // of the run's first voxel
  for (const Run& run : classes_.at(c).runs) {
    const auto scanline = static_cast<std::int64_t>(run.scanline);
    std::array<std::int64_t, 3> at{run.start, scanline % size[1], scanline / size[1]};
    for (std::uint32_t n = axis == 0 || at[axis] == index ? 0 : run.length; n < run.length; ++n, ++at[0]) {
      if (at[axis] != index) continue;
      const auto place = static_cast<std::size_t>(at[across] * size[along] + at[along]);
      pixels.labels[place] = label;
      if (values.empty()) continue;
      const double grey = visit_voxel_type(atlas_->value_type(), [&](auto tag) {
        return static_cast<double>(reinterpret_cast<const decltype(tag)*>(values.data())[value + n]);
      });
      const double position = (grey - low) * scale;
      pixels.greys[place] =
          static_cast<std::uint8_t>(position > 0 ? std::lround(std::min(position, 255.0)) : 0);
    }
    value += run.length;
  }
}

Result<nlohmann::ordered_json> PageSlices::slice(int axis, std::int64_t index) {
  constexpr std::int64_t kMaxPixels = std::int64_t{1} << 24;
  const Index3& size = atlas_->grid().size;
  const auto a = static_cast<std::size_t>(axis);
  if (a >= 3 || index < 0 || index >= size[a])
    return fail(ErrorCode::kNotFound, "slice {} across axis {}: none", index, axis);
  const std::int64_t count = atlas_->grid().voxels() / size[a];
  if (count > kMaxPixels)
    return fail(ErrorCode::kLimit, "a slice has {} voxels; {} are allowed", count, kMaxPixels);
  Pixels pixels;
  pixels.labels.resize(static_cast<std::size_t>(count));
  pixels.greys.resize(pixels.labels.size());
  Result<void> read;
  for (ClassId c = 1; c < atlas_->classes().size(); ++c) {
    check_task();
    const IndexBox& box = atlas_->classes().box(c);
    if (box.first[a] > index || index > box.last[a]) continue;
    if (!classes_.contains(c)) {
      Result<void> decoded = decode(c);
      // Pictures tell what is damaged
      if (!decoded && decoded.error().code == ErrorCode::kInvalidAtlas)
        classes_[c] = {};
      else if (!decoded)
        read = std::move(decoded);
    }
    if (read) paint(c, a, index, pixels);
  }
  SPLATLAS_RETURN_IF_ERROR(std::move(read));

  constexpr const char* kDigits = "0123456789abcdef";
  std::vector<std::int64_t> runs;
  std::string greys;
  for (std::size_t n = 0; n < pixels.labels.size(); ++n) {
    if (runs.empty() || runs[runs.size() - 2] != pixels.labels[n])
      runs.insert(runs.end(), {pixels.labels[n], 0});
    ++runs.back();
    greys += {kDigits[pixels.greys[n] >> 4], kDigits[pixels.greys[n] & 15]};
  }
  return nlohmann::ordered_json{{"labels", runs}, {"greys", greys}};
}

}  // namespace splatlas
