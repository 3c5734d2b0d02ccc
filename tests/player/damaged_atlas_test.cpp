// Pictures of damaged files: damage is reported, and stays local.
#include <gmock/gmock.h>

#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/fails_with.h"
#include "tests/support/phantom_content.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

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
                     const RenderOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open_bytes(std::move(file), "F"));
  Renderer renderer(atlas, {.threads = 1});
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  return renderer.render(camera, options);
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
  for (int n = 0; n < 2; ++n)
    EXPECT_THAT(renderer.render({}, {.size = {8, 8}}), FailsWith(ErrorCode::kInvalidAtlas, testing::_));
  // Other structures can still be drawn; then the damage is reported again.
  ASSERT_TRUE(renderer.select(selection_of("Sphere_2", content.graph)));
  EXPECT_TRUE(frame_or_throw(renderer, {}, {.size = {8, 8}}).missing.empty());
  ASSERT_TRUE(renderer.select(selection_of("*", content.graph)));
  EXPECT_EQ(frame_or_throw(renderer, {}, {.size = {8, 8}}).missing.size(), 1u);
}

}  // namespace
}  // namespace splatlas
