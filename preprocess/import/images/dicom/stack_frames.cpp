#include "preprocess/import/images/dicom/stack_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/images/pixels/check_image_file.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

using Frames = std::vector<const DicomFrame*>;

bool is_near(std::span<const double> a, std::span<const double> b, double tolerance) {
  return std::ranges::equal(a, b, [&](double x, double y) { return std::abs(x - y) <= tolerance; });
}

bool belong_together(const DicomFrame& a, const DicomFrame& b) {
  constexpr double kOrientation = 1e-3, kSpacing = 1e-4;
  if (a.is_segmentation || b.is_segmentation)
    return a.is_segmentation == b.is_segmentation && a.file == b.file &&
           is_near(a.row, b.row, kOrientation) && is_near(a.column, b.column, kOrientation) &&
           is_near(a.spacing, b.spacing, kSpacing);
  return a.series_uid == b.series_uid && a.pixels.rows == b.pixels.rows &&
         a.pixels.columns == b.pixels.columns && is_near(a.row, b.row, kOrientation) &&
         is_near(a.column, b.column, kOrientation) && is_near(a.spacing, b.spacing, kSpacing);
}

bool repeats(std::span<const SlicePosition> positions) {
  return std::ranges::any_of(positions, [](const SlicePosition& p) { return p.frames.size() > 1; });
}

/// Numbers without leading zeros sort by value.
struct ByNumber {
  bool operator()(const std::string& a, const std::string& b) const {
    return std::pair(a.size(), a) < std::pair(b.size(), b);
  }
};

constexpr std::array<const char*, kSplitKeys> kKeyNames{"thickness",   "echo",    "time",        "image type",
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

bool are_volumes(std::span<const Frames> parts, bool must_be_even) {
  return parts.size() > 1 && std::ranges::all_of(parts, [&](const Frames& part) {
           const std::vector<SlicePosition> positions = slice_positions(part);
           return positions.size() > 1 && !repeats(positions) &&
                  (!must_be_even || slice_steps(positions).is_even());
         });
}

std::vector<FrameStack> named_parts(std::vector<Frames> parts, const std::string& name) {
  std::vector<FrameStack> stacks;
  for (std::size_t n = 0; n < parts.size(); ++n)
    stacks.push_back({std::move(parts[n]), fmt::format("{} {} of {}", name, n + 1, parts.size())});
  return stacks;
}

std::vector<FrameStack> split_group(const Frames& group) {
  const std::vector<SlicePosition> positions = slice_positions(group);
  const bool has_repeats = repeats(positions);
  if (group.front()->is_segmentation || (!has_repeats && slice_steps(positions).is_even()))
    return {{group, ""}};
  // Volumes with gaps are told apart, too, so that the gap is reported and not a mixture read.
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

using Positions = std::vector<SlicePosition>;

const Vec3& place(const SlicePosition& position) {
  return position.frames.front()->position;
}

/// a + t (b - a)
Vec3 between(const Vec3& a, const Vec3& b, double t) {
  return {std::lerp(a[0], b[0], t), std::lerp(a[1], b[1], t), std::lerp(a[2], b[2], t)};
}

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// "(0, 0, 2) to (0, 0, 6)" for the first of some steps, "and 2 more".
std::string list_steps(const Positions& positions, const std::vector<std::size_t>& steps) {
  constexpr std::size_t kMaxListed = 3;
  std::string text;
  for (std::size_t n = 0; n < std::min(steps.size(), kMaxListed); ++n) {
    text += fmt::format("{}{} to {}", n == 0 ? "" : ", ", position_text(place(positions[steps[n]])),
                        position_text(place(positions[steps[n] + 1])));
  }
  if (steps.size() > kMaxListed) text += fmt::format(" and {} more", steps.size() - kMaxListed);
  return text;
}

Result<void> check_even(const Positions& positions, const std::filesystem::path& path) {
  const SliceSteps steps = slice_steps(positions);
  if (!steps.uneven.empty()) {
    return bad_file(path,
                    "has slices at uneven steps: most are {:.6g} mm, but not {}; dcm2niix resamples them",
                    steps.median_mm, list_steps(positions, steps.uneven));
  }
  if (steps.gaps.empty()) return {};
  return bad_file(
      path, "lacks {} slice{} at steps of {:.6g} mm, from {}; add the files, or dcm2niix resamples them",
      steps.missing, steps.missing == 1 ? "" : "s", steps.median_mm, list_steps(positions, steps.gaps));
}

/// True if all positions are multiples of a step from the first.
bool are_multiples(const Positions& positions, double step_mm) {
  return std::ranges::all_of(positions, [&](const SlicePosition& position) {
    const double times = (position.height - positions.front().height) / step_mm;
    return std::abs(times - std::round(times)) * step_mm <= max_deviation_mm(step_mm);
  });
}

/// The step of slices of which empty ones are left out; 0 if there is none.
double sparse_step(const Positions& positions) {
  double least = positions.back().height - positions.front().height;
  for (std::size_t n = 1; n < positions.size(); ++n)
    least = std::min(least, positions[n].height - positions[n - 1].height);
  const double declared = positions.front().frames.front()->slice_spacing;
  if (declared > 0 && declared <= least + max_deviation_mm(least) && are_multiples(positions, declared))
    return declared;
  return are_multiples(positions, least) ? least : 0;
}

/// Number of slices from the first to the last.
Result<std::int64_t> count_slices(const Positions& positions, SliceGaps gaps,
                                  const std::filesystem::path& path) {
  if (gaps == SliceGaps::kMissing || positions.size() < 2) {
    SPLATLAS_RETURN_IF_ERROR(check_even(positions, path));
    return static_cast<std::int64_t>(positions.size());
  }
  const double step = sparse_step(positions);
  if (!(step > 0)) {
    return bad_file(path, "has slices at uneven steps from {} to {}; dcm2niix resamples them",
                    position_text(place(positions.front())), position_text(place(positions.back())));
  }
  const double steps = std::round((positions.back().height - positions.front().height) / step);
  if (steps >= static_cast<double>(kMaxAxisSize))
    return bad_file(path, "has {} slices at steps of {} mm, which is too many", steps + 1, step);
  return static_cast<std::int64_t>(steps) + 1;
}

void set_single_slice(const DicomFrame& frame, Grid& grid, Notes& notes) {
  static const NoteKind kUnknown{"slice-thickness", "slice has no thickness; 1 mm is assumed",
                                 "slices have no thickness; 1 mm is assumed", true};
  const double known = frame.slice_spacing > 0 ? frame.slice_spacing : frame.thickness;
  if (!(known > 0)) notes.add(kUnknown, position_text(frame.position));
  grid.spacing_mm[2] = known > 0 ? known : 1;
}

/// Sets the third axis: along the step if the stack is tilted, else along the normal.
void set_step(const Positions& positions, std::int64_t slices, Vec3& axis, Grid& grid, Notes& notes) {
  constexpr double kMinTilt = 1e-3;
  static const NoteKind kTilted{"tilted-stack", "stack of slices is tilted; its grid is sheared",
                                "stacks of slices are tilted; their grids are sheared"};
  const Vec3 &first = place(positions.front()), &last = place(positions.back());
  const double along = positions.back().height - positions.front().height;
  const Vec3 shift{(last[0] - first[0]) / along - axis[0], (last[1] - first[1]) / along - axis[1],
                   (last[2] - first[2]) / along - axis[2]};
  const double tilt = std::hypot(shift[0], shift[1], shift[2]);
  const auto steps = static_cast<double>(slices - 1);
  grid.spacing_mm[2] = along / steps;
  if (tilt <= kMinTilt) return;
  const double length = distance(first, last);
  for (std::size_t a = 0; a < 3; ++a) axis[a] = (last[a] - first[a]) / length;
  grid.spacing_mm[2] = length / steps;
  notes.add(kTilted, fmt::format("{:.1f} degrees", std::atan(tilt) * 180 / std::numbers::pi));
}

/// Puts the frames into their slices. kFailed for frames beside the line from the first to the last.
Result<void> place_slices(const Positions& positions, const std::filesystem::path& path,
                          SlicedStack& sliced) {
  const auto count = static_cast<std::size_t>(sliced.grid.size[2]);
  sliced.slices.resize(count);
  const Vec3 &first = place(positions.front()), &last = place(positions.back());
  const double height = positions.back().height - positions.front().height;
  const double step = count == 1 ? sliced.grid.spacing_mm[2] : height / static_cast<double>(count - 1);
  for (const SlicePosition& position : positions) {
    const double k = std::round((position.height - positions.front().height) / step);
    const double share = count == 1 ? 0 : k / static_cast<double>(count - 1);
    const Vec3 expected = between(first, last, share);
    for (const DicomFrame* frame : position.frames) {
      if (const double off = distance(frame->position, expected);
          off > max_deviation_mm(step) + kSamePosition) {
        return bad_file(
            path, "has a slice at {} that is {:.4g} mm off the line of the others; dcm2niix resamples them",
            position_text(frame->position), off);
      }
    }
    sliced.slices[static_cast<std::size_t>(k)] = position.frames;
  }
  return {};
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
  const std::vector<SlicePosition> positions = slice_positions(stack.frames);
  const SliceSteps steps = slice_steps(positions);
  std::string text = fmt::format("{} {}x{}x{}, {:.4g}x{:.4g}", first.modality, first.pixels.columns,
                                 first.pixels.rows, positions.size(), first.spacing[0], first.spacing[1]);
  text += positions.size() > 1 ? fmt::format("x{:.4g} mm", steps.median_mm) : " mm";
  if (!stack.part.empty()) text += ", " + stack.part;
  return text;
}

Result<SlicedStack> slice_stack(const FrameStack& stack, SliceGaps gaps, const std::filesystem::path& path) {
  const Positions positions = slice_positions(stack.frames);
  const DicomFrame& first = *positions.front().frames.front();
  SPLATLAS_ASSIGN_OR_RETURN(const std::int64_t count, count_slices(positions, gaps, path));
  SlicedStack sliced;
  Grid& grid = sliced.grid;
  grid.size = {first.pixels.columns, first.pixels.rows, count};
  grid.spacing_mm = {first.spacing[0], first.spacing[1], 1};
  grid.origin_lps_mm = first.position;
  Vec3 axis = normal_of(first);
  if (count == 1) {
    set_single_slice(first, grid, sliced.notes);
  } else {
    set_step(positions, count, axis, grid, sliced.notes);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    grid.direction_lps[3 * a] = first.row[a];
    grid.direction_lps[3 * a + 1] = first.column[a];
    grid.direction_lps[3 * a + 2] = axis[a];
  }
  SPLATLAS_RETURN_IF_ERROR(validate(grid, path.string()));
  SPLATLAS_RETURN_IF_ERROR(payload_bytes(path, grid.size, sizeof(float)));
  SPLATLAS_RETURN_IF_ERROR(place_slices(positions, path, sliced));
  return sliced;
}

Vec3 normal_of(const DicomFrame& frame) {
  return cross(frame.row, frame.column);
}

std::vector<SlicePosition> slice_positions(std::span<const DicomFrame* const> frames) {
  if (frames.empty()) return {};
  const Vec3 normal = normal_of(*frames.front());
  std::vector<SlicePosition> sorted;
  for (const DicomFrame* frame : frames) {
    sorted.push_back({dot(normal, frame->position), {frame}});
  }
  std::ranges::stable_sort(sorted, {}, &SlicePosition::height);
  std::vector<SlicePosition> positions;
  for (SlicePosition& next : sorted) {
    if (!positions.empty() && next.height - positions.back().height <= kSamePosition) {
      positions.back().frames.push_back(next.frames.front());
    } else {
      positions.push_back(std::move(next));
    }
  }
  return positions;
}

double max_deviation_mm(double step_mm) {
  constexpr double kShare = 0.01, kRounding = 0.01, kMaxShare = 0.05;
  return std::max(kShare * step_mm, std::min(kRounding, kMaxShare * step_mm));
}

SliceSteps slice_steps(std::span<const SlicePosition> positions) {
  SliceSteps steps;
  if (positions.size() < 2) return steps;
  std::vector<double> lengths;
  for (std::size_t n = 1; n < positions.size(); ++n)
    lengths.push_back(positions[n].height - positions[n - 1].height);
  std::vector<double> sorted = lengths;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) / 2);
  std::ranges::nth_element(sorted, middle);
  steps.median_mm = *middle;
  for (std::size_t n = 0; n < lengths.size(); ++n) {
    const double times = std::round(lengths[n] / steps.median_mm);
    const double deviation = std::abs(lengths[n] - times * steps.median_mm);
    if (times < 1 || deviation > max_deviation_mm(times * steps.median_mm)) {
      steps.uneven.push_back(n);
    } else if (times > 1) {
      steps.gaps.push_back(n);
      steps.missing += static_cast<std::size_t>(times) - 1;
    }
  }
  return steps;
}

std::string position_text(const Vec3& position_lps_mm) {
  const auto rounded = [](double mm) { return std::round(mm * 1000) / 1000 + 0.0; };  // never -0
  return fmt::format("({}, {}, {})", rounded(position_lps_mm[0]), rounded(position_lps_mm[1]),
                     rounded(position_lps_mm[2]));
}

void note_duplicate(const DicomFrame& frame, Notes& notes) {
  static const NoteKind kDuplicates{"duplicate-slices", "slice repeats another's position and is ignored",
                                    "slices repeat others' positions and are ignored", true};
  notes.add(kDuplicates, position_text(frame.position));
}

}  // namespace splatlas
