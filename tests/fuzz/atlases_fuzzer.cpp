// Fuzz target: untrusted atlas files, with right or wrong checksums, opened, verified, read and rendered.
// Each operation must stay within its estimate of work. Input: the file. Its reserved header field, which
// readers ignore, chooses the frame and the largest estimate.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/decision_tree.h"
#include "format/file/file_layout.h"
#include "player/frame/render_overrides.h"
#include "player/render_frame.h"
#include "player/spans/class_cache.h"
#include "tests/fuzz/cost_limit.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

/// Operations of at most this estimate are run: of one input in 16 up to a second with sanitizers, and of the
/// others up to a tenth, because executions per second find more. Estimates above the budget of the file are
/// run, too: they must be refused at once.
constexpr double kMaxUnits = 3e7, kUsualMaxUnits = 2e6;
/// The writer has no estimate: files of about 2^16 voxels are written again.
constexpr double kMaxRewrittenUnits = 1e6;
constexpr std::uint64_t kRenderBytes = std::uint64_t{64} << 20;

bool is_refused(const Atlas& atlas, const Work& work) {
  return !atlas.work_budget().check(work, "it");
}

/// An open file, and the largest estimate of operations that are run.
struct OpenAtlas {
  std::shared_ptr<const Atlas> atlas;
  double max_units;
};

bool is_run(const OpenAtlas& file, const Work& work) {
  return work.units() <= file.max_units || is_refused(*file.atlas, work);
}

/// Limit of an operation of this estimate, or of its refusal.
Cost limit_in(const Atlas& atlas, const Work& work) {
  return limit_of(is_refused(atlas, work) ? Work() : work);
}

/// Random choices from the header field.
class Choices {
 public:
  explicit Choices(std::uint32_t bits) : bits_(bits) {}
  [[nodiscard]] std::size_t below(std::uint32_t n) {
    const std::uint32_t number = bits_ % n;
    bits_ /= n;
    return number;
  }
  [[nodiscard]] bool flag() { return below(2) != 0; }

 private:
  std::uint32_t bits_;
};

struct Frame {
  Camera camera;
  RenderOptions options;
  RenderOverrides overrides = {};
};

/// Sheets or rays, at any quality, zoom and angle.
Frame read_frame(Choices& choices) {
  Frame frame;
  frame.options.size = {std::array{1, 5, 12}[choices.below(3)], 7};
  frame.options.quality = static_cast<Quality>(choices.below(3));
  frame.options.classification = choices.flag() ? Classification::kAfter : Classification::kBefore;
  frame.options.hybrid_shading = choices.below(8) == 0;  // builds a table of all normals, most of the time
  frame.options.depth_cue = choices.flag() ? DepthCue::kEdges : DepthCue::kNone;
  frame.overrides.simd = choices.flag();
  frame.camera.projection = choices.flag() ? CameraProjection::kPerspective : CameraProjection::kParallel;
  frame.camera.zoom = std::array{0.5, 1.0, 4.0, 40.0}[choices.below(4)];
  frame.camera.azimuth_deg = 45.0 * static_cast<double>(choices.below(8));
  frame.camera.elevation_deg = std::array{0.0, 13.0, -45.0, 90.0, 1e-5}[choices.below(5)];
  return frame;
}

Selection read_selection(Choices& choices, const Atlas& atlas) {
  static const std::array<const char*, 4> kTexts{"*:both", "*:volume(opacity=0.9)", "*:surface(opacity=0.5)",
                                                 "*:both(opacity=0.4,curve=0:0:0.2/90:0.5)"};
  const std::size_t choice = choices.below(6);
  if (choice >= kTexts.size() && !atlas.scenes().empty()) {
    const auto selection = select(atlas.scenes().front().selection, atlas.graph());
    if (selection) return *selection;
    require_error(selection.error(), {ErrorCode::kUsage, ErrorCode::kNotFound});
  }
  return require_value(select(kTexts[choice % kTexts.size()], atlas.graph()));
}

/// Premultiplied colours are at most alpha.
void check_pixels(const Picture& picture) {
  constexpr float kRounding = 1e-5f;
  for (std::size_t p = 0; p + 3 < picture.rgba.size(); p += 4) {
    const float opacity = picture.rgba[p + 3];
    require(opacity >= 0 && opacity <= 1 + kRounding, "an opacity out of range");
    for (std::size_t c = 0; c < 3; ++c)
      require(picture.rgba[p + c] >= 0 && picture.rgba[p + c] <= opacity + kRounding,
              "a colour out of range");
  }
}

/// verify(). True if the atlas is sound, false also if that takes too long to find out.
bool is_sound(const OpenAtlas& file) {
  const Atlas& atlas = *file.atlas;
  const Work work = atlas.work_of_verify();
  if (!is_run(file, work)) return false;
  const CostLimit limit(limit_in(atlas, work), "verify()");
  const auto verified = atlas.verify();
  require(!is_refused(atlas, work) || !verified, "work beyond the budget is done");
  if (!verified) require_error(verified.error(), {ErrorCode::kInvalidAtlas, ErrorCode::kLimit});
  require(verified || is_refused(atlas, work) == (verified.error().code == ErrorCode::kLimit),
          "the budget refuses other work");
  return verified.has_value();
}

/// Work of the selection along the axes with the least and the most: the view decides between them.
struct SelectionWork {
  Work least, most;
};

SelectionWork work_of_selection(const std::shared_ptr<const Atlas>& atlas, const DrawPlan& plan,
                                const Frame& frame) {
  const ClassCache cache(atlas);
  std::array<Work, 3> of_axes;
  for (const Axis axis : kAxes) {
    Work& work = of_axes[static_cast<std::size_t>(axis)];
    work = cache.work_of(volume_classes(plan), axis, frame.options.hybrid_shading);
    work.then(cache.work_of_surfaces(plan.surfaces));
  }
  const auto [least, most] = std::ranges::minmax(of_axes, {}, &Work::units);
  return {least, most};
}

/// Upper bound of the work behind the selection: of the box of rays (player/rays/ray_volume.cpp) and of
/// sheets of one to four pixels per voxel (player/frame/sheet_frame.cpp).
Work work_of_box(const Atlas& atlas, const DrawPlan& plan) {
  constexpr double kMargin = 4, kPerVoxel = 1, kBytesPerVoxel = 16, kPixelsPerVoxel = 4;
  constexpr double kPerPixel = 80, kBytesPerPixel = 32;
  Work work;
  IndexBox box;
  for (const ClassId c : volume_classes(plan)) box.include(atlas.classes().box(c));
  if (box.empty()) return work;
  const auto side = [&](std::size_t a) { return static_cast<double>(box.last[a] - box.first[a]) + kMargin; };
  const double voxels = side(0) * side(1) * side(2);
  const double length = std::max({side(0), side(1), side(2)});
  double pixels = 0;  // the shear of a slice is at most the number of slices
  for (std::size_t a = 0; a < 3; ++a)
    pixels = std::max(pixels, (side(a) + side((a + 2) % 3)) * (side((a + 1) % 3) + side((a + 2) % 3)));
  pixels *= kPixelsPerVoxel;
  work.add(WorkKind::kVoxels, voxels, kPerVoxel);
  work.add(WorkKind::kPixels, pixels, kPerPixel);
  work.hold(std::max(kBytesPerVoxel * voxels, kBytesPerPixel * pixels) + kBytesPerPixel * length);
  return work;
}

/// Files that pass verify() must render. Others may fail, with a message.
void check_pictures(const OpenAtlas& file, bool sound, Choices& choices) {
  const std::shared_ptr<const Atlas>& atlas = file.atlas;
  if (atlas->graph().size() == 0) return;
  const Selection selection = read_selection(choices, *atlas);
  Frame frame = read_frame(choices);
  const DrawPlan plan = DecisionTree(atlas->graph(), atlas->classes()).plan(selection);
  const SelectionWork of_selection = work_of_selection(atlas, plan, frame);
  const bool refused = is_refused(*atlas, of_selection.least);
  Work work = of_selection.most;
  work += work_of_box(*atlas, plan);
  if (!refused && work.units() > file.max_units) return;
  Renderer renderer(atlas, {.threads = 1, .max_memory_bytes = kRenderBytes});
  if (const auto selected = renderer.select(selection); !selected)
    return require_error(selected.error(), {ErrorCode::kLimit});
  const auto render = [&](const char* what) {
    const CostLimit limit(limit_of(refused ? Work() : work), what);
    return render_with(renderer, frame.camera, frame.options, frame.overrides);
  };
  const auto picture = render("a picture");
  if (!picture) {
    require_error(picture.error(), {ErrorCode::kInvalidAtlas, ErrorCode::kLimit, ErrorCode::kUsage});
    require(!sound || picture.error().code != ErrorCode::kInvalidAtlas,
            "a sound atlas cannot be drawn: " + picture.error().message);
    return;
  }
  require(!refused, "work beyond the budget is done");
  check_pixels(*picture);
  if (choices.below(4) != 0) return;
  frame.overrides.simd = !frame.overrides.simd;
  const Picture reference = require_value(render("a picture by the other kernels"));
  for (std::size_t n = 0; n < reference.rgba.size(); ++n)
    require(std::abs(reference.rgba[n] - picture->rgba[n]) <= 2e-5f, "SIMD and scalar pictures differ");
}

/// Everything in a valid file can be read. The contents, if they are few.
std::optional<AtlasContent> read_content(const OpenAtlas& file, bool sound) {
  const Atlas& atlas = *file.atlas;
  const Work work = atlas.work_of_all();
  if (!is_run(file, work)) return std::nullopt;
  const CostLimit limit(limit_in(atlas, work), "read_all()");
  auto content = atlas.read_all();
  require(!is_refused(atlas, work) || !content, "work beyond the budget is done");
  if (content) return work.units() <= kMaxRewrittenUnits ? std::optional(std::move(*content)) : std::nullopt;
  require_error(content.error(), {ErrorCode::kInvalidAtlas, ErrorCode::kLimit});
  require(!sound || content.error().code == ErrorCode::kLimit, "a sound atlas cannot be read");
  return std::nullopt;
}

/// Contents of a valid file survive a round trip.
void check_rewriting(const AtlasContent& content) {
  const auto bytes = require_value(encode_atlas(content, {.level = 1, .threads = 1}));
  const auto again = require_value(Atlas::open_bytes(bytes));
  require(again->verify().has_value(), "an atlas is not sound when written again");
  const AtlasContent content_again = require_value(again->read_all());
  require(require_value(encode_atlas(content_again, {.level = 1, .threads = 1})) == bytes,
          "an atlas is another one when written again");
}

}  // namespace

/// Each of verify(), two pictures and read_all() may take 1 s and 12 MiB (kMaxUnits), and writing again and
/// opening as much.
InputLimit input_limit() {
  return {.floor = {6, 48 << 20}, .per_byte = {50e-6, 4096}};
}

void fuzz(FuzzInput input) {
  const auto file = input.rest();
  std::uint32_t reserved = 0;
  if (file.size() >= sizeof(FileHeader))
    std::memcpy(&reserved, &file[offsetof(FileHeader, reserved)], sizeof reserved);
  Choices choices(reserved);
  const bool rewrites = choices.below(8) == 0;

  const auto opened = Atlas::open_bytes({file.begin(), file.end()}, "F", {.max_work = 1.0 / 40});
  if (!opened) return require_error(opened.error(), {ErrorCode::kInvalidAtlas});
  // Other bits of the field than those of Choices
  const OpenAtlas atlas{*opened, reserved * 2654435761u >> 28 == 1 ? kMaxUnits : kUsualMaxUnits};
  const bool sound = is_sound(atlas);
  check_pictures(atlas, sound, choices);
  if (sound && !rewrites) return;
  const auto content = read_content(atlas, sound);
  if (content && sound) check_rewriting(*content);
}

}  // namespace splatlas
