#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "format/content/selection.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

StructureGraph two_structures() {
  return *StructureGraph::build({{.id = "a", .name = "A"}, {.id = "b", .name = "B"}});
}

/// The second structure as volume with this appearance.
Selection drawn(const StructureDraw& draw) {
  Selection selection{{StructureDraw{.mode = DrawMode::kSurface}, draw}};
  if (draw.mode == DrawMode::kOff) selection.structures[1].mode = DrawMode::kBoth;
  return selection;
}

Selection styled(const VolumeStyle& style) {
  return drawn({.volume = style});
}

VolumeStyle curve(std::vector<TransferPoint> points) {
  return {.curve = std::make_shared<const TransferCurve>(TransferCurve{std::move(points)})};
}

constexpr float kNanOpacity = std::numeric_limits<float>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(CheckSelection, NamesTheStructureAndTheValue) {
  const StructureGraph graph = two_structures();
  const std::pair<Selection, const char*> cases[] = {
      {drawn({.mode = static_cast<DrawMode>(4)}), "mode 4 must be off, volume, surface or both"},
      {drawn({.opacity = kNanOpacity}), "opacity nan must be from 0 to 1"},
      {drawn({.opacity = -1.0f}), "opacity -1 must be from 0 to 1"},
      {drawn({.mode = DrawMode::kSurface, .opacity = 1.5f}), "opacity 1.5 must be from 0 to 1"},
      {styled({.profile = static_cast<TransferProfile>(3)}), "profile 3 must be soft, thin or hard"},
      {styled({.low = NAN}), "low nan must be finite"},
      {styled({.low = -kInfinity}), "low -inf must be finite"},
      {styled({.high = kInfinity}), "high inf must be finite"},
      {styled({.low = 5, .high = 5}), "low 5 must be below high 5"},
      {styled({.low = 6, .high = 5}), "low 6 must be below high 5"},
      {styled(curve({})), "the curve has no points"},
      {styled({.low = 1, .curve = curve({{0, 0.5f}}).curve}), "a curve replaces profile, low and high"},
  };
  for (const auto& [selection, message] : cases) {
    const auto checked = check_selection(selection, graph);
    EXPECT_THAT(checked, FailsWith(ErrorCode::kUsage, HasSubstr(message)));
    EXPECT_THAT(checked, FailsWith(ErrorCode::kUsage, HasSubstr("selection: structure 1 (\"b\"): ")));
  }
}

TEST(CheckSelection, RefusesMoreStructuresThanTheGraphHas) {
  const StructureGraph graph = two_structures();
  EXPECT_TRUE(check_selection({}, graph));
  EXPECT_TRUE(check_selection({std::vector<StructureDraw>(2)}, graph));
  EXPECT_THAT(check_selection({std::vector<StructureDraw>(3)}, graph),
              FailsWith(ErrorCode::kUsage, HasSubstr("3 structures, but the atlas has 2")));
}

TEST(CheckSelection, AcceptsTheEndsOfEveryRange) {
  const StructureGraph graph = two_structures();
  for (const Selection& selection :
       {drawn({.opacity = 0.0f}), drawn({.opacity = 1.0f, .color = {255, 255, 255}}),
        styled({.profile = TransferProfile::kHard, .low = -1e300, .high = 1e300}), styled({.low = 1e300}),
        styled({.high = -1e300}), styled(curve({{0, 0}})),
        styled(curve({{0, 0}, {1, kMaxVolumeOpacity, 0}}))}) {
    const auto checked = check_selection(selection, graph);
    EXPECT_TRUE(checked) << checked.error().message;
  }
}

TEST(CheckSelection, IgnoresTheAppearanceOfStructuresThatAreOff) {
  Selection selection = drawn({.opacity = -1.0f});
  selection.structures[1].mode = DrawMode::kOff;
  EXPECT_TRUE(check_selection(selection, two_structures()));
}

}  // namespace
}  // namespace splatlas
