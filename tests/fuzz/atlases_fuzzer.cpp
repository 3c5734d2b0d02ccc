// Fuzz target: untrusted atlas files, with right or wrong checksums, opened, verified, read and rendered.
// Each operation must stay within its estimate of work. Input: the file. Its reserved header field, which
// readers ignore, chooses the frame and the largest estimate.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/file/file_layout.h"
#include "player/renderer.h"
#include "tests/fuzz/cost_limit.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

/// Budget of each operation: 0.1 s and 7 MiB.
constexpr double kMaxWork = 1.0 / 300;
constexpr std::uint64_t kMemory = 14 << 20;
/// Sanitizers and other programs delay the look at the clock. Several parts may hold memory at once.
constexpr Cost kLimit{1.5, 48 << 20};
/// The writer has no budget: files of few voxels are written again.
constexpr std::int64_t kMaxRewrittenVoxels = 1 << 16;
constexpr std::uint64_t kRenderBytes = std::uint64_t{64} << 20;

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

struct Drawing {
  Camera camera;
  RenderOptions options;
  RenderOverrides overrides = {};
};

/// Sheets or rays, at any quality, zoom and angle.
Drawing read_drawing(Choices& choices) {
  Drawing drawing;
  drawing.options.size = {std::array{1, 5, 12}[choices.below(3)], 7};
  drawing.options.quality = static_cast<Quality>(choices.below(3));
  drawing.options.classification = choices.flag() ? Classification::kAfter : Classification::kBefore;
  drawing.options.hybrid_shading = choices.below(8) == 0;  // builds a table of all normals, most of the time
  drawing.options.depth_cue = choices.flag() ? DepthCue::kEdges : DepthCue::kNone;
  drawing.overrides.simd = choices.flag();
  drawing.camera.projection = choices.flag() ? CameraProjection::kPerspective : CameraProjection::kParallel;
  drawing.camera.zoom = std::array{0.5, 1.0, 4.0, 40.0}[choices.below(4)];
  drawing.camera.azimuth_deg = 45.0 * static_cast<double>(choices.below(8));
  drawing.camera.elevation_deg = std::array{0.0, 13.0, -45.0, 90.0, 1e-5}[choices.below(5)];
  return drawing;
}

Selection read_selection(Choices& choices, const Atlas& atlas) {
  static const std::array<const char*, 4> kTexts{"*:both", "*:volume(opacity=0.9)", "*:surface(opacity=0.5)",
                                                 "*:both(opacity=0.4,curve=0:0:0.2/90:0.5)"};
  const std::size_t choice = choices.below(6);
  if (choice >= kTexts.size() && !atlas.scenes().empty()) {
    const auto selection = Selection::parse(atlas.scenes().front().selection, atlas.graph());
    if (selection) return *selection;
    require_error(selection.error(), {ErrorCode::kUsage, ErrorCode::kNotFound});
  }
  return require_value(Selection::parse(kTexts[choice % kTexts.size()], atlas.graph()));
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
bool is_sound(const Atlas& atlas) {
  const CostLimit limit(kLimit, "verify()");
  const auto verified = atlas.verify();
  if (!verified) require_error(verified.error(), {ErrorCode::kInvalidAtlas, ErrorCode::kLimit});
  return verified.has_value();
}

/// Files that pass verify() must render. Others may fail, with a message.
void check_pictures(const std::shared_ptr<const Atlas>& atlas, bool sound, Choices& choices) {
  if (atlas->graph().size() == 0) return;
  const Selection selection = read_selection(choices, *atlas);
  Drawing drawing = read_drawing(choices);
  Renderer renderer(atlas, {.threads = 1, .max_memory_bytes = kRenderBytes});
  if (const auto selected = renderer.select(selection); !selected)
    return require_error(selected.error(), {ErrorCode::kLimit});
  const auto render = [&](const char* what) {
    const CostLimit limit(kLimit, what);
    return render_with(renderer, drawing.camera, drawing.options, drawing.overrides);
  };
  const auto frame = render("a picture");
  if (!frame) {
    require_error(frame.error(), {ErrorCode::kInvalidAtlas, ErrorCode::kLimit, ErrorCode::kUsage});
    require(!sound || frame.error().code != ErrorCode::kInvalidAtlas,
            "a sound atlas cannot be drawn: " + frame.error().message);
    return;
  }
  check_pixels(frame->picture);
  if (choices.below(4) != 0) return;
  drawing.overrides.simd = !drawing.overrides.simd;
  const auto reference = render("a picture by the other kernels");
  if (!reference) return require_error(reference.error(), {ErrorCode::kLimit});
  const std::vector<float>&expected = reference->picture.rgba, &drawn = frame->picture.rgba;
  for (std::size_t n = 0; n < expected.size(); ++n)
    require(std::abs(expected[n] - drawn[n]) <= 2e-5f, "SIMD and scalar pictures differ");
}

/// Everything in a valid file can be read. The contents, if they are few.
std::optional<AtlasContent> read_content(const Atlas& atlas, bool sound) {
  const CostLimit limit(kLimit, "read_all()");
  auto content = atlas.read_all();
  if (content)
    return atlas.grid().voxels() <= kMaxRewrittenVoxels ? std::optional(std::move(*content)) : std::nullopt;
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

void fuzz_atlases(FuzzInput input) {
  const auto file = input.rest();
  std::uint32_t reserved = 0;
  if (file.size() >= sizeof(FileHeader))
    std::memcpy(&reserved, &file[offsetof(FileHeader, reserved)], sizeof reserved);
  Choices choices(reserved);
  const bool rewrites = choices.below(8) == 0;

  const auto opened =
      Atlas::open_bytes({file.begin(), file.end()}, "F", {.max_work = kMaxWork, .memory_bytes = kMemory});
  if (!opened) return require_error(opened.error(), {ErrorCode::kInvalidAtlas});
  const bool sound = is_sound(**opened);
  check_pictures(*opened, sound, choices);
  if (sound && !rewrites) return;
  const auto content = read_content(**opened, sound);
  if (content && sound) check_rewriting(*content);
}

/// Each of verify(), two pictures and read_all() may take kLimit, and writing again and opening as much.
const FuzzTarget kAtlases("atlases", fuzz_atlases,
                          InputLimit{.floor = {8, 96 << 20}, .per_byte = {50e-6, 4096}});

}  // namespace
}  // namespace splatlas
