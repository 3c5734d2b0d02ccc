#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/dicom_frame.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

using Frames = std::vector<const DicomFrame*>;

bool is_near(std::span<const double> a, std::span<const double> b, double tolerance) {
  return std::ranges::equal(a, b, [&](double x, double y) { return std::abs(x - y) <= tolerance; });
}

bool belong_together(const DicomFrame& a, const DicomFrame& b) {
  constexpr double kOrientation = 1e-3, kSpacing = 1e-4;
  const bool is_one_series =
      a.is_segmentation ? a.file == b.file
                        : a.series_uid == b.series_uid && a.frame_of_reference == b.frame_of_reference &&
                              a.pixels.rows == b.pixels.rows && a.pixels.columns == b.pixels.columns;
  return a.is_segmentation == b.is_segmentation && is_one_series && is_near(a.row, b.row, kOrientation) &&
         is_near(a.column, b.column, kOrientation) && is_near(a.spacing, b.spacing, kSpacing);
}

/// Positions within this distance are one, in mm.
constexpr double kSamePosition = 1e-3;

/// Maximum deviation of a slice: 1 % of the step, at least the rounding of 0.01 mm in positions.
double max_deviation_mm(double step_mm) {
  constexpr double kShare = 0.01, kRounding = 0.01, kMaxShare = 0.05;
  return std::max(kShare * step_mm, std::min(kRounding, kMaxShare * step_mm));
}

struct SlicePosition {
  double height = 0;  ///< mm along the normal
  Frames frames;
};
using Positions = std::vector<SlicePosition>;

std::vector<double> steps_of(const Positions& positions) {
  std::vector<double> steps;
  for (std::size_t n = 1; n < positions.size(); ++n)
    steps.push_back(positions[n].height - positions[n - 1].height);
  return steps;
}

/// In ascending order along the first normal. Those within kSamePosition, or 5 % of the median step, are one.
Positions slice_positions(const Frames& frames) {
  constexpr double kNear = 0.05;
  const Vec3 normal = normal_of(*frames.front());
  Positions positions;
  for (const DicomFrame* frame : frames) positions.push_back({dot(normal, frame->position), {frame}});
  std::ranges::stable_sort(positions, {}, &SlicePosition::height);
  const auto merge = [&](double distance_mm) {
    for (SlicePosition& next : std::exchange(positions, {})) {
      if (!positions.empty() && next.height - positions.back().height <= distance_mm) {
        std::ranges::copy(next.frames, std::back_inserter(positions.back().frames));
      } else {
        positions.push_back(std::move(next));
      }
    }
  };
  merge(kSamePosition);
  if (std::vector<double> steps = steps_of(positions); !steps.empty()) {
    const auto middle = steps.begin() + std::ssize(steps) / 2;
    std::ranges::nth_element(steps, middle);
    merge(std::max(kSamePosition, kNear * *middle));
  }
  return positions;
}

double span_of(const Positions& positions) {
  return positions.back().height - positions.front().height;
}

/// Coordinates of the positions along the third axis, in steps from the first.
std::vector<double> places_of(const Positions& positions, double step_mm) {
  std::vector<double> places;
  for (const SlicePosition& position : positions) {
    const double times = (position.height - positions.front().height) / step_mm, whole = std::round(times);
    places.push_back(std::abs(times - whole) * step_mm <= max_deviation_mm(step_mm) ? whole : times);
  }
  return places;
}

/// True if all positions are multiples of a step from the first.
bool are_multiples(const Positions& positions, double step_mm) {
  return std::ranges::all_of(places_of(positions, step_mm), [](double p) { return p == std::round(p); });
}

/// The least step of several positions, without the rounding of single ones.
double least_step(const Positions& positions) {
  const std::vector<double> steps = steps_of(positions);
  const double least = std::ranges::min(steps);
  double sum = 0, count = 0;
  for (const double step : steps) {
    if (step > least + max_deviation_mm(least)) continue;
    sum += step;
    ++count;
  }
  const double span = span_of(positions), even = span / std::round(span * count / sum);
  return are_multiples(positions, even) ? even : sum / count;
}

/// The step of a grid. Segmentations may leave out empty slices, so that only the file knows it.
double grid_step(const Positions& positions, SliceGaps gaps) {
  const double least = least_step(positions), declared = positions.front().frames.front()->slice_spacing;
  const bool is_declared = gaps == SliceGaps::kEmpty && declared > 0 &&
                           declared <= least + max_deviation_mm(least) && are_multiples(positions, declared);
  return is_declared ? declared : least;
}

/// True if no position is missing between the first and the last, and none is between others.
bool is_even(const Positions& positions) {
  if (positions.size() < 2) return true;
  const double step = least_step(positions);
  return are_multiples(positions, step) &&
         places_of(positions, step).back() < static_cast<double>(positions.size());
}

bool repeats(const Positions& positions) {
  return std::ranges::any_of(positions, [](const SlicePosition& p) { return p.frames.size() > 1; });
}

/// Numbers without leading zeros sort by value.
struct ByNumber {
  bool operator()(const std::string& a, const std::string& b) const {
    return std::pair(a.size(), a) < std::pair(b.size(), b);
  }
};

constexpr std::array<const char*, kSplitKeys> kKeyNames{"echo",        "time",    "image type",
                                                        "acquisition", "b-value", "trigger time"};

std::vector<Frames> parts_by(const Frames& frames, std::size_t first, std::size_t second) {
  std::map<std::string, std::map<std::string, Frames, ByNumber>, ByNumber> parts;
  for (const DicomFrame* frame : frames)
    parts[frame->split_keys[first]][frame->split_keys[second]].push_back(frame);
  std::vector<Frames> list;
  for (auto& [text, inner] : parts) {
    for (auto& [inner_text, part] : inner) list.push_back(std::move(part));
  }
  return list;
}

/// Parts that lie one behind the other are slabs of one volume.
bool are_volumes(std::span<const Frames> parts, bool must_be_even) {
  std::vector<std::pair<double, double>> ranges;
  for (const Frames& part : parts) {
    const Positions positions = slice_positions(part);
    if (positions.size() < 2 || repeats(positions) || (must_be_even && !is_even(positions))) return false;
    ranges.emplace_back(positions.front().height, positions.back().height);
  }
  std::ranges::sort(ranges);
  return std::ranges::adjacent_find(ranges, [](const auto& lower, const auto& upper) {
           return upper.first < lower.second - kSamePosition;
         }) != ranges.end();
}

std::vector<FrameStack> named_parts(std::vector<Frames> parts, const std::string& name) {
  std::vector<FrameStack> stacks;
  for (std::size_t n = 0; n < parts.size(); ++n)
    stacks.push_back({std::move(parts[n]), fmt::format("{} {} of {}", name, n + 1, parts.size())});
  return stacks;
}

std::vector<FrameStack> split_group(const Frames& group) {
  const Positions positions = slice_positions(group);
  const bool has_repeats = repeats(positions);
  if (group.front()->is_segmentation || (!has_repeats && is_even(positions))) return {{group, ""}};
  // Volumes with gaps are told apart, too, so that no mixture is read.
  for (const bool must_be_even : {true, false}) {
    if (!must_be_even && !has_repeats) break;
    for (const bool in_pairs : {false, true}) {
      for (std::size_t a = 0; a < kSplitKeys; ++a) {
        for (std::size_t b = in_pairs ? a + 1 : a; b < (in_pairs ? kSplitKeys : a + 1); ++b) {
          std::vector<Frames> parts = parts_by(group, a, b);
          if (!are_volumes(parts, must_be_even)) continue;
          const std::string name = kKeyNames[a];
          return named_parts(std::move(parts), in_pairs ? name + " and " + kKeyNames[b] : name);
        }
      }
    }
  }
  return {{group, ""}};
}

const Vec3& place(const SlicePosition& position) {
  return position.frames.front()->position;
}

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Notes the voxels' slices that lie between those of the files.
void note_uneven(const Positions& positions, const SlicedStack& sliced, const std::string& tilt,
                 Notes& notes) {
  constexpr std::size_t kMaxListed = 3;
  const Affine to_mm = index_to_lps_mm(sliced.grid);
  const auto [least, greatest] = std::ranges::minmax(steps_of(positions));
  std::string text = fmt::format("{}steps of {:.4g} to {:.4g} mm become {:.4g} mm",
                                 tilt.empty() ? "" : "tilt " + tilt + ", ", least, greatest, sliced.step_mm);
  std::size_t between = 0;
  for (std::int64_t k = 0; k < sliced.grid.size[2]; ++k) {
    if (std::ranges::binary_search(sliced.places, static_cast<double>(k))) continue;
    if (++between <= kMaxListed)
      text += (between == 1 ? ", new slices at " : ", ") +
              position_text(to_mm.apply({0, 0, static_cast<double>(k)}));
  }
  if (between > kMaxListed) text += fmt::format(" and {} more", between - kMaxListed);
  if (between > 0) notes.add("uneven-slices", text);
}

void set_single_slice(const DicomFrame& frame, Grid& grid, Notes& notes) {
  const double known = frame.slice_spacing > 0 ? frame.slice_spacing : frame.thickness;
  if (!(known > 0)) notes.add("slice-thickness", position_text(frame.position));
  grid.spacing_mm[2] = known > 0 ? known : 1;
}

/// Sets the third axis: along the stack if it is tilted, else along the normal. Returns the tilt as text.
std::string set_axis(const Positions& positions, double step_mm, Vec3& axis, Grid& grid) {
  constexpr double kMinTilt = 1e-3;
  const Vec3 &first = place(positions.front()), &last = place(positions.back());
  const double along = span_of(positions);
  const Vec3 shift{(last[0] - first[0]) / along - axis[0], (last[1] - first[1]) / along - axis[1],
                   (last[2] - first[2]) / along - axis[2]};
  const double tilt = std::hypot(shift[0], shift[1], shift[2]);
  grid.spacing_mm[2] = step_mm;
  if (tilt <= kMinTilt) return {};
  const double length = distance(first, last);
  for (std::size_t a = 0; a < 3; ++a) axis[a] = (last[a] - first[a]) / length;
  grid.spacing_mm[2] *= length / along;
  return fmt::format("{:.1f} degrees", std::atan(tilt) * 180 / std::numbers::pi);
}

/// kFailed for frames beside the line from the first to the last.
Result<void> check_line(const Positions& positions, double step_mm, const std::filesystem::path& path) {
  const SlicePosition &first = positions.front(), &last = positions.back();
  const Vec3 normal = normal_of(*first.frames.front());
  for (const SlicePosition& position : positions) {
    for (const DicomFrame* frame : position.frames) {
      const double height = dot(normal, frame->position) - first.height;
      const double share = positions.size() == 1 ? 0 : height / span_of(positions);
      Vec3 on_line;
      for (std::size_t a = 0; a < 3; ++a) on_line[a] = std::lerp(place(first)[a], place(last)[a], share);
      const double off = distance(frame->position, on_line);
      if (off > max_deviation_mm(step_mm) + kSamePosition) {
        return bad_file(
            path, "has a slice at {} that is {:.4g} mm off the line of the others; dcm2niix resamples them",
            position_text(frame->position), off);
      }
    }
  }
  return {};
}

/// The frames of each slice of a segmentation's grid. Slices without any are empty, unless the steps are
/// uneven: then the nearest frames count.
void spread_slices(bool is_even, SlicedStack& sliced) {
  const auto frames = std::exchange(sliced.slices, {});
  sliced.slices.resize(static_cast<std::size_t>(sliced.grid.size[2]));
  for (std::size_t k = 0, n = 0; k < sliced.slices.size(); ++k) {
    const auto far = [&](std::size_t m) { return std::abs(sliced.places[m] - static_cast<double>(k)); };
    while (n + 1 < frames.size() && far(n + 1) < far(n)) ++n;
    if (!is_even || far(n) < 1.0 / 2) sliced.slices[k] = frames[n];
  }
}

}  // namespace

std::vector<FrameStack> group_frames(std::span<const DicomFrame> frames) {
  std::vector<Frames> groups;
  for (const DicomFrame& frame : frames) {
    const auto found = std::ranges::find_if(
        groups, [&](const Frames& group) { return belong_together(*group.front(), frame); });
    if (found != groups.end()) {
      found->push_back(&frame);
    } else {
      groups.push_back({&frame});
    }
  }
  std::ranges::stable_sort(groups, {}, [](const Frames& group) { return group.front()->series_number; });
  std::vector<FrameStack> stacks;
  for (const Frames& group : groups) std::ranges::move(split_group(group), std::back_inserter(stacks));
  return stacks;
}

std::string description(const FrameStack& stack) {
  const DicomFrame& first = *stack.frames.front();
  const Positions positions = slice_positions(stack.frames);
  std::string text = fmt::format("{} {}x{}x{}, {:.4g}x{:.4g}", first.modality, first.pixels.columns,
                                 first.pixels.rows, positions.size(), first.spacing[0], first.spacing[1]);
  text += positions.size() > 1 ? fmt::format("x{:.4g} mm", least_step(positions)) : " mm";
  if (!stack.part.empty()) text += ", " + stack.part;
  return text;
}

Result<SlicedStack> slice_stack(const FrameStack& stack, SliceGaps gaps, const std::filesystem::path& path) {
  const Positions positions = slice_positions(stack.frames);
  const DicomFrame& first = *positions.front().frames.front();
  SlicedStack sliced;
  Grid& grid = sliced.grid;
  grid.size = {first.pixels.columns, first.pixels.rows, 1};
  grid.spacing_mm = {first.spacing[0], first.spacing[1], 1};
  grid.origin_lps_mm = first.position;
  Vec3 axis = normal_of(first);
  std::string tilt;
  if (positions.size() == 1) {
    set_single_slice(first, grid, sliced.notes);
    sliced.step_mm = grid.spacing_mm[2];
  } else {
    sliced.step_mm = grid_step(positions, gaps);
    tilt = set_axis(positions, sliced.step_mm, axis, grid);
  }
  sliced.places = places_of(positions, sliced.step_mm);
  if (const double last = std::ceil(sliced.places.back()); last < static_cast<double>(kMaxAxisSize)) {
    grid.size[2] = static_cast<std::int64_t>(last) + 1;
  } else {
    return bad_file(path, "has {} slices at steps of {} mm, which is too many", last + 1, sliced.step_mm);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    grid.direction_lps[3 * a] = first.row[a];
    grid.direction_lps[3 * a + 1] = first.column[a];
    grid.direction_lps[3 * a + 2] = axis[a];
  }
  SPLATLAS_RETURN_IF_ERROR(validate(grid, path.string()));
  SPLATLAS_RETURN_IF_ERROR(payload_bytes(path, grid.size, sizeof(float)));
  SPLATLAS_RETURN_IF_ERROR(check_line(positions, sliced.step_mm, path));
  for (const SlicePosition& position : positions) sliced.slices.push_back(position.frames);
  const bool is_even = are_multiples(positions, sliced.step_mm);
  if (!is_even || (gaps == SliceGaps::kMissing && grid.size[2] > std::ssize(positions))) {
    note_uneven(positions, sliced, tilt, sliced.notes);
  } else if (!tilt.empty()) {
    sliced.notes.add("tilted-stack", tilt);
  }
  if (gaps == SliceGaps::kEmpty) spread_slices(is_even, sliced);
  return sliced;
}

Vec3 normal_of(const DicomFrame& frame) {
  return cross(frame.row, frame.column);
}

std::string position_text(const Vec3& position_lps_mm) {
  const auto rounded = [](double mm) { return std::round(mm * 1000) / 1000 + 0.0; };  // never -0
  return fmt::format("({}, {}, {})", rounded(position_lps_mm[0]), rounded(position_lps_mm[1]),
                     rounded(position_lps_mm[2]));
}

void note_duplicate(const DicomFrame& frame, Notes& notes) {
  notes.add("duplicate-slices", position_text(frame.position));
}

}  // namespace splatlas
