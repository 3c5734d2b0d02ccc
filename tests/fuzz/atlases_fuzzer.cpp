// Whole atlases from strangers, checksums right or wrong: opened, verified, read and rendered within bounds
// of time and memory. Input: the file. Its reserved header field, which readers do not look at, says what is
// rendered.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/file_layout.h"
#include "player/render_frame.h"
#include "tests/fuzz/cost_limit.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

/// A file may say that it holds much more than this in few bytes, and is believed until it is read: then time
/// and memory follow what it says, which is no finding. Of such files only opening is bounded.
constexpr std::int64_t kSmallGridVoxels = 1 << 15;
constexpr std::uint64_t kSmallTriangles = 1 << 14;
constexpr std::uint64_t kRenderBytes = std::uint64_t{64} << 20;

bool is_small(const Atlas& atlas) {
  std::uint64_t triangles = 0;
  for (StructureIndex s = 0; s < atlas.graph().size(); ++s) triangles += atlas.triangles(s);
  return atlas.grid().voxels() <= kSmallGridVoxels && triangles <= kSmallTriangles;
}

struct Frame {
  Camera camera;
  RenderOptions options;
};

/// Sheets or rays, in any quality, near or far, at any angle.
Frame read_frame(FuzzInput& input) {
  Frame frame;
  const auto choices = input.number<std::uint8_t>();
  frame.options.size = {1 + static_cast<int>(choices & 15), 9};
  frame.options.quality = static_cast<Quality>((choices >> 4) % 3);
  frame.options.depth_cue = (choices & 64) != 0 ? DepthCue::kEdges : DepthCue::kNone;
  frame.options.simd = (choices & 128) != 0;
  const auto view = input.number<std::uint8_t>();
  if ((view & 1) != 0) frame.options.classification = Classification::kAfter;
  if ((view & 2) != 0) frame.camera.projection = CameraProjection::kPerspective;
  frame.options.hybrid_shading = (view & 4) == 0;
  frame.camera.zoom = std::array{0.5, 1.0, 4.0, 40.0}[view >> 3 & 3];
  frame.camera.azimuth_deg = 45.0 * (view >> 5);
  const auto elevation = input.number<std::uint8_t>();
  frame.camera.elevation_deg = elevation < 8 ? 0 : elevation - 128.0;
  return frame;
}

Selection read_selection(FuzzInput& input, const Atlas& atlas) {
  static const std::array<const char*, 4> kTexts{"*:both", "*:volume(opacity=0.9)", "*:surface(opacity=0.5)",
                                                 "*:both(opacity=0.4,curve=0:0:0.2/90:0.5)"};
  const std::size_t choice = input.below(8);
  if (choice >= kTexts.size() && !atlas.scenes().empty()) {
    const auto selection = select(atlas.scenes().front().selection, atlas.graph());
    if (selection) return *selection;
    require_error(selection.error(), {ErrorCode::kUsage, ErrorCode::kNotFound});
  }
  return require_value(select(kTexts[choice % kTexts.size()], atlas.graph()));
}

/// Colours are at most as strong as they are opaque.
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

/// Files that verify() finds sound can be drawn; others may fail, in words.
void check_pictures(const std::shared_ptr<const Atlas>& atlas, bool sound, FuzzInput input) {
  if (atlas->graph().size() == 0) return;
  const Selection selection = read_selection(input, *atlas);
  Frame frame = read_frame(input);
  Renderer renderer(atlas, {.threads = 1, .max_memory_bytes = kRenderBytes});
  if (const auto selected = renderer.select(selection); !selected)
    return require_error(selected.error(), {ErrorCode::kLimit});
  const auto picture = renderer.render(frame.camera, frame.options);
  if (!picture) {
    require_error(picture.error(), {ErrorCode::kInvalidAtlas, ErrorCode::kLimit, ErrorCode::kUsage});
    require(!sound || picture.error().code != ErrorCode::kInvalidAtlas,
            "a sound atlas cannot be drawn: " + picture.error().message);
    return;
  }
  check_pixels(*picture);
  frame.options.simd = !frame.options.simd;
  const Picture twin = require_value(renderer.render(frame.camera, frame.options));
  for (std::size_t n = 0; n < twin.rgba.size(); ++n)
    require(std::abs(twin.rgba[n] - picture->rgba[n]) <= 1e-3f, "vectors and scalars draw two pictures");
}

/// Everything that a sound file holds can be read, and written again so that it is read as before.
void check_rewriting(const Atlas& atlas) {
  const auto content = atlas.read_all();
  if (!content) return require_error(content.error(), {ErrorCode::kLimit});
  const auto bytes = require_value(encode_atlas(*content, {.level = 1, .threads = 1}));
  const auto again = require_value(Atlas::open_bytes(bytes));
  require(again->verify().has_value(), "an atlas is not sound when written again");
  const AtlasContent content_again = require_value(again->read_all());
  require(require_value(encode_atlas(content_again, {.level = 1, .threads = 1})) == bytes,
          "an atlas is another one when written again");
}

void fuzz(FuzzInput input) {
  const auto file = input.rest();
  std::uint32_t choices = 0;
  if (file.size() >= sizeof(FileHeader))
    std::memcpy(&choices, &file[offsetof(FileHeader, reserved)], sizeof choices);
  const CostLimit limit;
  const auto opened = Atlas::open_bytes({file.begin(), file.end()}, "F");
  if (!opened) return require_error(opened.error(), {ErrorCode::kInvalidAtlas});
  const std::shared_ptr<const Atlas>& atlas = *opened;
  if (!is_small(*atlas)) return;
  const auto verified = atlas->verify();
  if (!verified) require_error(verified.error(), {ErrorCode::kInvalidAtlas});
  check_pictures(atlas, verified.has_value(),
                 {reinterpret_cast<const std::uint8_t*>(&choices), sizeof choices});
  if (!verified) {
    (void)atlas->read_all();
  } else if (choices % 8 == 0) {
    check_rewriting(*atlas);
  }
}

}  // namespace
}  // namespace splatlas

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splatlas::fuzz({data, size});
  return 0;
}
