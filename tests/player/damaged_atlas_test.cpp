// Pictures of damaged files: every change comes with an error, and damage stays local.
#include <cmath>
#include <map>

#include <gmock/gmock.h>

#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/phantom_content.h"
#include "tests/support/render.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

using testing::HasSubstr;

/// Two balls, and a bar that intersects one of them, in 10 x 9 x 8 voxels.
AtlasContent small_content() {
  TestVolume volume;
  volume.grid.size = {10, 9, 8};
  const auto ball = [&](double ci, double cj, double ck, double radius) {
    return make_mask(volume.grid.size, [=](auto i, auto j, auto k) {
      return std::hypot(static_cast<double>(i) - ci, static_cast<double>(j) - cj,
                        static_cast<double>(k) - ck) < radius;
    });
  };
  const auto bar = make_mask(volume.grid.size, [](auto, auto j, auto k) { return j == 4 && k < 3; });
  volume.structures = {{"a", ball(2.5, 3, 3, 2.6), {255, 0, 0}},
                       {"b", ball(7, 5, 4, 2.9), {0, 255, 0}},
                       {"bar", bar, {0, 0, 255}}};
  std::vector<std::uint8_t> values;
  for (int n = 0; n < 10 * 9 * 8; ++n) values.push_back(static_cast<std::uint8_t>(60 + n * 7 % 190));
  volume.values = make_values(VoxelType::kUInt8, values);
  volume.window_high = 250;
  return make_content(volume);
}

/// File offset of a chunk of a section.
std::size_t offset_of(const Bytes& file, SectionKind kind, std::size_t chunk = 0) {
  const AtlasParts parts = take_apart(file);
  const FileLayout layout = lay_out(parts.directory, directory_bytes(file).size()).value();
  return layout.chunk_offset[layout.find(kind)->first_chunk + chunk];
}

/// The file with one byte of a chunk changed.
Bytes with_damage(Bytes file, SectionKind kind, std::size_t chunk = 0) {
  file[offset_of(file, kind, chunk)] ^= std::byte{1};
  return file;
}

/// A frame, or the error of any step.
Result<Frame> render(Bytes file, const Selection& selection, const Camera& camera,
                     const RenderOptions& options, const RenderOverrides& overrides = {}) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open_bytes(std::move(file), "F"));
  Renderer renderer(atlas, {.threads = 1});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  return render_with(renderer, camera, options, overrides);
}

TEST(DamagedAtlas, AVolumeThatIsDamagedIsLeftOutWhole) {
  const AtlasContent content = phantom_content();
  const Bytes file = encode_atlas(content).value();
  const RenderOptions options{.size = {32, 32}};
  for (const SectionKind kind :
       {SectionKind::kValues, SectionKind::kRunsX, SectionKind::kRunsY, SectionKind::kRunsZ}) {
    // One chunk per structure; in values the empty class comes first.
    const Bytes damaged = with_damage(file, kind, kind == SectionKind::kValues ? 1 : 0);
    std::size_t pictures_with_damage = 0;
    for (const NamedView view : {NamedView::kLeft, NamedView::kAnterior, NamedView::kSuperior}) {
      const auto got =
          render(damaged, selection_of("*:volume", content.graph), Camera::of(view), options).value();
      const bool is_hit = !got.missing.empty();
      pictures_with_damage += is_hit;
      const auto expected = render(file, selection_of(is_hit ? "Sphere_2" : "*:volume", content.graph),
                                   Camera::of(view), options)
                                .value();
      EXPECT_EQ(got.picture.rgba, expected.picture.rgba);
      if (!is_hit) continue;
      ASSERT_EQ(got.missing.size(), 1u);
      EXPECT_THAT(describe(got.missing[0], content.graph),
                  HasSubstr("\"Sphere_1\": its volume of 4145 voxels is missing: F: damaged: checksum of " +
                            section_name(static_cast<std::uint32_t>(kind))));
    }
    EXPECT_EQ(pictures_with_damage, kind == SectionKind::kValues || kind == SectionKind::kRunsZ ? 3u : 1u);
  }
}

TEST(DamagedAtlas, ASurfaceThatIsDamagedIsLeftOut) {
  const AtlasContent content = phantom_content();
  const Bytes file = encode_atlas(content).value();
  const RenderOptions options{.size = {32, 32}};
  const auto got =
      render(with_damage(file, SectionKind::kSurfaces), selection_of("*:surface", content.graph), {}, options)
          .value();
  const auto expected = render(file, selection_of("Sphere_2:surface", content.graph), {}, options).value();
  EXPECT_EQ(got.picture.rgba, expected.picture.rgba);
  ASSERT_EQ(got.missing.size(), 1u);
  EXPECT_EQ(describe(got.missing[0], content.graph),
            "\"Sphere_1\": its surface is missing: F: damaged: checksum of surfaces of structure 'Sphere_1'");
}

TEST(DamagedAtlas, AFaceOfACutThatIsDamagedIsLeftOut) {
  const AtlasContent content = phantom_content();
  const Bytes file = encode_atlas(content).value();
  const Selection selection = selection_of("*:surface", content.graph);
  RenderOptions options{.size = {32, 32}};
  ASSERT_TRUE(options.cuts.add({{0, 0, 1}, content.display.center_lps_mm[2]}));
  const Camera camera = Camera::of(NamedView::kSuperior);
  const auto intact = render(file, selection, camera, options).value();
  EXPECT_TRUE(intact.missing.empty());
  const auto got = render(with_damage(file, SectionKind::kValues, 1), selection, camera, options).value();
  ASSERT_EQ(got.missing.size(), 1u);
  EXPECT_THAT(describe(got.missing[0], content.graph), HasSubstr("\"Sphere_1\": its volume of"));
  options.caps = CapMode::kNone;
  const auto hollow = render(file, selection, camera, options).value();
  EXPECT_NE(got.picture.rgba, intact.picture.rgba);
  EXPECT_EQ(got.picture.rgba, hollow.picture.rgba) << "the plane cuts the damaged structure alone";
}

TEST(DamagedAtlas, WhereNothingIsLeftItIsAnErrorEachTime) {
  const AtlasContent content = phantom_content();
  const Bytes damaged = with_damage(encode_atlas(content).value(), SectionKind::kValues, 1);
  Renderer renderer(Atlas::open_bytes(damaged, "F").value(), {.threads = 1});
  ASSERT_TRUE(renderer.select(selection_of("Sphere_1", content.graph)));
  for (int n = 0; n < 2; ++n) {
    const auto picture = renderer.render({}, {.size = {8, 8}});
    ASSERT_FALSE(picture);
    EXPECT_EQ(picture.error().code, ErrorCode::kInvalidAtlas);
  }
  // Other structures can still be drawn; then the damage is reported again.
  ASSERT_TRUE(renderer.select(selection_of("Sphere_2", content.graph)));
  EXPECT_TRUE(frame_or_throw(renderer, {}, {.size = {8, 8}}).missing.empty());
  ASSERT_TRUE(renderer.select(selection_of("*", content.graph)));
  EXPECT_EQ(frame_or_throw(renderer, {}, {.size = {8, 8}}).missing.size(), 1u);
}

/// Changes every byte in turn: the picture is the same, or damage is reported and the picture shows the rest.
TEST(DamagedAtlas, NoFlippedByteChangesAPictureWithoutAnError) {
  const AtlasContent content = small_content();
  const Bytes file = encode_atlas(content).value();
  const Selection selection = selection_of("a:volume + b:both", content.graph);
  std::map<std::string, std::size_t> outcomes;
  Renderer good(Atlas::open_bytes(file).value(), {.threads = 1});
  const std::size_t normals = offset_of(file, SectionKind::kNormals);
  const std::size_t surfaces = offset_of(file, SectionKind::kSurfaces);
  for (std::size_t n = 0; n < file.size(); ++n) {
    RenderOptions options{.size = {9, 9}, .quality = Quality::kDraft};
    const RenderOverrides overrides{.principal_axis = static_cast<Axis>(n % 3)};
    options.hybrid_shading =
        n >= normals && n < surfaces;  // elsewhere shading reads no normals, and is slowest
    options.classification = n % 5 == 0 ? Classification::kAfter : Classification::kBefore;
    const Camera camera{.azimuth_deg = 40, .elevation_deg = 35};
    Bytes flipped = file;
    flipped[n] ^= static_cast<std::byte>(1u << (n % 8));
    const auto got = render(std::move(flipped), selection, camera, options, overrides);
    if (!got) {
      EXPECT_EQ(got.error().code, ErrorCode::kInvalidAtlas) << n << ": " << got.error().message;
      ++outcomes["error"];
      continue;
    }
    ++outcomes[got->missing.empty() ? "unharmed" : "part"];
    ASSERT_TRUE(good.select(without(selection, got->missing)));
    ASSERT_EQ(got->picture.rgba, render_or_throw(good, camera, options, overrides).rgba)
        << "byte " << n << ": "
        << (got->missing.empty() ? "nothing is missing" : describe(got->missing[0], content.graph));
  }
  EXPECT_GT(outcomes["error"], sizeof(FileHeader));
  EXPECT_GT(outcomes["part"], 100u);
  EXPECT_GT(outcomes["unharmed"], 100u);
}

}  // namespace
}  // namespace splatlas
