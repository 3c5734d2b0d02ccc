// Frames of one volume.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "preprocess/import/images/dicom/slice_positions.h"
#include "preprocess/import/images/dicom/stack_frames.h"

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

std::vector<FrameStack> split(const Frames& group) {
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
  for (const Frames& group : groups) std::ranges::move(split(group), std::back_inserter(stacks));
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

}  // namespace splatlas
