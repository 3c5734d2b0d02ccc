// Pictures of forged files: one run model disagrees with the others, under right checksums.
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/phantom_content.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

using Change = std::function<void(ClassRuns&, std::uint32_t side)>;

/// Mirrors the scanlines of a run model.
void mirror(ClassRuns& runs, std::uint32_t side) {
  for (Run& run : runs) run.start = side - run.start - run.length;
  std::ranges::sort(runs);
}
void shift(ClassRuns& runs, std::uint32_t side) {
  const bool forward =
      std::ranges::all_of(runs, [&](const Run& run) { return run.start + run.length < side; });
  for (Run& run : runs) forward ? ++run.start : --run.start;
}
/// Moves one run within its scanline.
void move_run(ClassRuns& runs, std::uint32_t side) {
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const bool is_last = n + 1 == runs.size() || runs[n + 1].scanline != runs[n].scanline;
    if (!is_last || runs[n].start + runs[n].length == side) continue;
    ++runs[n].start;
    return;
  }
}

/// The file with other runs of a class along one axis; checksums are right.
Bytes with_runs(const Bytes& file, ClassId c, Axis axis, const Change& change) {
  AtlasParts parts = take_apart(file);
  // The list of another class holds its voxels.
  if (parts.directory.run_bytes[c][static_cast<std::size_t>(axis)] == 0) return file;
  const Grid grid = reordered(parts.directory.source_grid, parts.directory.source_to_storage);
  const auto side = static_cast<std::uint32_t>(grid.size[ScanOrder::of(axis).scan_axis]);
  edit_run_list(parts, c, axis, [&](ClassRuns& runs) { change(runs, side); });
  return put_together(parts);
}

/// A picture, or nothing if an error or a missing part tells that it would be wrong.
Result<std::vector<float>> honest_picture(const Bytes& file, const char* selection, NamedView view) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open_bytes(file, "F"));
  Renderer renderer(atlas, {.threads = 1});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection_of(selection, atlas->graph())));
  SPLATLAS_ASSIGN_OR_RETURN(Frame frame, renderer.render(Camera::of(view), {.size = {24, 24}}));
  if (!frame.missing.empty()) return tl::unexpected(frame.missing.front().error);
  return std::move(frame.picture.rgba);
}

constexpr std::array kViews{NamedView::kLeft, NamedView::kAnterior, NamedView::kSuperior};
constexpr std::array kSelections{"*:volume", "*:surface"};

TEST(ForgedAtlas, GivesNoWrongPicture) {
  const Bytes file = encode_atlas(phantom_content()).value();
  const std::size_t classes = take_apart(file).directory.classes.size();
  std::map<std::pair<NamedView, std::string>, std::vector<float>> expected;
  for (const NamedView view : kViews) {
    for (const char* selection : kSelections)
      expected[{view, selection}] = honest_picture(file, selection, view).value();
  }
  std::size_t forged = 0, refused = 0;
  for (const auto& [name, change] :
       std::map<std::string, Change>{{"mirror", mirror}, {"shift", shift}, {"move", move_run}}) {
    for (ClassId c = 1; c < classes; ++c) {
      for (const Axis axis : kAxes) {
        const Bytes bad = with_runs(file, c, axis, change);
        if (bad == file) continue;
        ++forged;
        std::size_t errors = 0;
        for (const NamedView view : kViews) {
          for (const char* selection : kSelections) {
            const auto got = honest_picture(bad, selection, view);
            errors += got ? 0 : 1;
            const bool right =
                !got || *got == expected.at(std::pair<NamedView, std::string>(view, selection));
            EXPECT_TRUE(right) << name << " class " << c << " axis " << static_cast<int>(axis) << " "
                               << selection;
          }
        }
        refused += errors > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(forged, 15u);
  EXPECT_GT(refused, forged / 2);
}

}  // namespace
}  // namespace splatlas
