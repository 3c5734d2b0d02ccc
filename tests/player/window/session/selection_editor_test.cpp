#include "player/window/session/selection_editor.h"

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_graph.h"
#include "tests/player/window/two_sided_graph.h"

namespace splatlas {
namespace {

using two_sided::Index;

class SelectionEditorTest : public testing::Test {
 protected:
  [[nodiscard]] DrawMode mode(StructureIndex s) const { return editor_.selection().structures[s].mode; }
  [[nodiscard]] std::vector<DrawMode> leaf_modes() const {
    return {mode(Index::kGyrusLeft), mode(Index::kGyrusRight), mode(Index::kStem)};
  }

  StructureGraph graph_ = two_sided::graph();
  SelectionEditor editor_{graph_, two_sided::drawable()};
};

constexpr DrawMode kOff = DrawMode::kOff, kVolume = DrawMode::kVolume, kSurface = DrawMode::kSurface,
                   kBoth = DrawMode::kBoth;

TEST_F(SelectionEditorTest, BeginsWithEverythingAsVolume) {
  EXPECT_EQ(editor_.text(), "*");
  EXPECT_THAT(leaf_modes(), testing::ElementsAre(kVolume, kVolume, kVolume));
  EXPECT_TRUE(editor_.modes(Index::kBrain).is_only(kVolume));
  EXPECT_FALSE(editor_.can_undo());
}

TEST_F(SelectionEditorTest, AModeReachesTheSubtreeUnderEveryParent) {
  editor_.set_mode(Index::kLeft, kOff);
  EXPECT_THAT(leaf_modes(), testing::ElementsAre(kOff, kVolume, kVolume));
  EXPECT_TRUE(editor_.modes(Index::kLeft).is_only(kOff));
  EXPECT_TRUE(editor_.modes(Index::kRight).is_only(kVolume));
  for (const StructureIndex mixed : {Index::kLobe, Index::kBrain}) {
    EXPECT_TRUE(editor_.modes(mixed).contains(kOff) && editor_.modes(mixed).contains(kVolume));
    EXPECT_FALSE(editor_.modes(mixed).contains(kSurface));
    EXPECT_FALSE(editor_.modes(mixed).is_only(kVolume));
  }
}

TEST_F(SelectionEditorTest, AllChildrenAlikeAreNamedByTheirGroup) {
  editor_.hide_all();
  EXPECT_EQ(editor_.text(), "");
  editor_.set_mode(Index::kGyrusLeft, kSurface);
  EXPECT_EQ(editor_.text(), "left:surface");  // the only child is on, and so is the group
  editor_.set_mode(Index::kGyrusRight, kSurface);
  editor_.set_mode(Index::kStem, kSurface);
  EXPECT_THAT(leaf_modes(), testing::ElementsAre(kSurface, kSurface, kSurface));
  EXPECT_EQ(editor_.text(), "brain:surface");
  editor_.set_mode(Index::kGyrusLeft, kOff);
  editor_.set_mode(Index::kGyrusRight, kOff);
  EXPECT_TRUE(editor_.modes(Index::kLobe).is_only(kOff));
  EXPECT_EQ(mode(Index::kLobe), kOff);
}

TEST_F(SelectionEditorTest, IsolatesASubtreeAsItWas) {
  editor_.set_mode(Index::kGyrusRight, kBoth);
  editor_.isolate(Index::kLobe);
  EXPECT_THAT(leaf_modes(), testing::ElementsAre(kVolume, kBoth, kOff));
  editor_.hide_all();
  editor_.isolate(Index::kStem);  // was off
  EXPECT_THAT(leaf_modes(), testing::ElementsAre(kOff, kOff, kVolume));
  EXPECT_EQ(editor_.text(), "stem");
}

TEST_F(SelectionEditorTest, GhostsWhatIsOnAndNothingElse) {
  editor_.set_mode(Index::kStem, kOff);
  editor_.ghost_others(Index::kGyrusLeft);
  EXPECT_THAT(leaf_modes(), testing::ElementsAre(kVolume, kSurface, kOff));
  EXPECT_TRUE(editor_.selection().structures[Index::kGyrusRight].ghost);
  EXPECT_FALSE(editor_.selection().structures[Index::kGyrusLeft].ghost);
}

TEST_F(SelectionEditorTest, AppearancesSurviveAChangeOfModeButNotOff) {
  editor_.set_opacity(Index::kStem, 0.5f);
  editor_.set_color(Index::kStem, {1, 2, 3});
  editor_.set_mode(Index::kStem, kSurface);
  EXPECT_EQ(editor_.appearance(Index::kStem)->opacity, 0.5f);
  EXPECT_EQ(editor_.appearance(Index::kStem)->color, (Rgb{1, 2, 3}));
  editor_.set_mode(Index::kStem, kOff);
  EXPECT_EQ(editor_.appearance(Index::kStem), std::nullopt);
  editor_.set_mode(Index::kStem, kSurface);
  EXPECT_EQ(editor_.appearance(Index::kStem)->opacity, std::nullopt);
  EXPECT_EQ(editor_.appearance(Index::kStem)->color, graph_[Index::kStem].color);
}

TEST_F(SelectionEditorTest, TransferFunctionsSurviveEditsOfOtherThings) {
  ASSERT_TRUE(editor_.set_text("brain(profile=thin,low=3)"));
  editor_.set_opacity(Index::kStem, 0.5f);
  EXPECT_EQ(editor_.selection().structures[Index::kStem].volume.profile, TransferProfile::kThin);
  EXPECT_EQ(editor_.selection().structures[Index::kStem].volume.low, 3.0);
  editor_.set_mode(Index::kStem, kSurface);
  editor_.set_mode(Index::kStem, kBoth);
  editor_.set_color(Index::kStem, {1, 2, 3});
  EXPECT_EQ(editor_.appearance(Index::kStem)->volume.low, 3.0);
  editor_.undo();
  EXPECT_EQ(editor_.appearance(Index::kStem)->volume.low, 3.0);
  editor_.isolate(Index::kLeft);
  EXPECT_EQ(editor_.text(), "left(profile=thin,low=3)");
}

TEST_F(SelectionEditorTest, GroupsTakeTheTransferFunctionOfTheirChildren) {
  ASSERT_TRUE(editor_.set_text("gyrus*(curve=5:0.25/9:0) + stem(curve=5:0.25/9:0)"));
  editor_.set_opacity(Index::kBrain, 0.5f);
  EXPECT_EQ(editor_.text(), "brain(opacity=0.5,curve=5:0.25/9:0)");
}

TEST_F(SelectionEditorTest, KeepsTheUsersWords) {
  ASSERT_TRUE(editor_.set_text("  Gyrus*:both - \"right side\"\n"));
  EXPECT_EQ(editor_.text(), "Gyrus*:both - \"right side\"");
  EXPECT_THAT(leaf_modes(), testing::ElementsAre(kBoth, kOff, kOff));
  editor_.set_mode(Index::kStem, kVolume);  // the editor now owns the text
  EXPECT_EQ(*Selection::parse(editor_.text(), graph_), editor_.selection());
}

TEST_F(SelectionEditorTest, RefusesWordsThatItDoesNotUnderstand) {
  const std::uint64_t version = editor_.version();
  EXPECT_EQ(editor_.set_text("stem +").error().code, ErrorCode::kUsage);
  EXPECT_EQ(editor_.set_text("steam").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(editor_.text(), "*");
  EXPECT_EQ(editor_.version(), version);
  EXPECT_FALSE(editor_.can_undo());
}

TEST_F(SelectionEditorTest, ADraggedSliderIsOneStepOfUndo) {
  for (const float opacity : {0.3f, 0.2f, 0.1f}) editor_.set_opacity(Index::kStem, opacity);
  editor_.end_gesture();
  for (const float opacity : {0.4f, 0.5f}) editor_.set_opacity(Index::kStem, opacity);
  editor_.end_gesture();
  editor_.undo();
  EXPECT_EQ(editor_.appearance(Index::kStem)->opacity, 0.1f);
  editor_.undo();
  EXPECT_EQ(editor_.text(), "*");
  EXPECT_FALSE(editor_.can_undo());
  editor_.redo();
  EXPECT_EQ(editor_.appearance(Index::kStem)->opacity, 0.1f);
}

TEST_F(SelectionEditorTest, AnEditThatChangesNothingIsNoStep) {
  const std::uint64_t version = editor_.version();
  editor_.set_mode(Index::kStem, kVolume);
  EXPECT_EQ(editor_.version(), version);
  EXPECT_FALSE(editor_.can_undo());
}

TEST_F(SelectionEditorTest, GivesUpWithoutATrace) {
  editor_.isolate(Index::kStem);
  editor_.revert_to("*");
  EXPECT_EQ(editor_.text(), "*");
  EXPECT_FALSE(editor_.can_undo());
}

TEST(SelectionEditorOfNothing, HasAnEmptyText) {
  const StructureGraph graph;
  SelectionEditor editor(graph, {});
  EXPECT_EQ(editor.text(), "");
  editor.show_all();
  editor.hide_all();
  EXPECT_TRUE(editor.selection().empty());
}

/// One edit of any kind.
void edit(SelectionEditor& editor, StructureIndex s, std::size_t kind) {
  switch (kind) {
    case 0: editor.set_opacity(s, 0.25f); break;
    case 1: editor.set_opacity(s, std::nullopt); break;
    case 2: editor.set_color(s, {9, 9, 9}); break;
    case 3: editor.isolate(s); break;
    case 4: editor.ghost_others(s); break;
    case 5: editor.show_all(); break;
    case 6: editor.hide_all(); break;
    default: editor.set_mode(s, static_cast<DrawMode>(kind % 4)); break;
  }
}

RC_GTEST_PROP(SelectionEditorProperty, TextAndSelectionAlwaysSayTheSame, ()) {
  std::mt19937 random = *random_source();
  const auto below = [&random](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const StructureGraph graph = random_graph(1 + below(12), random);
  std::vector<bool> drawable(graph.size());
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    drawable[s] = graph.children(s).empty() || below(3) == 0;
  }
  SelectionEditor editor(graph, drawable);
  std::vector<std::string> texts{editor.text()};
  for (int n = 0; n < 8; ++n) {
    editor.end_gesture();
    edit(editor, static_cast<StructureIndex>(below(graph.size())), below(20));
    if (editor.text() != texts.back()) texts.push_back(editor.text());
    RC_ASSERT(*Selection::parse(editor.text(), graph) == editor.selection());
    for (StructureIndex s = 0; s < graph.size(); ++s) {
      ModeSet expected;
      for (const StructureIndex d : graph.descendants(s)) {
        if (drawable[d]) expected.insert(editor.selection().structures[d].mode);
      }
      for (const DrawMode mode : {kOff, kVolume, kSurface, kBoth}) {
        RC_ASSERT(editor.modes(s).contains(mode) == expected.contains(mode));
      }
    }
  }
  for (auto text = texts.rbegin(); text != texts.rend(); ++text) {
    RC_ASSERT(editor.text() == *text);
    editor.undo();
  }
  RC_ASSERT(!editor.can_undo());
  for (const std::string& text : texts) {
    RC_ASSERT(editor.text() == text);
    editor.redo();
  }
}

RC_GTEST_PROP(SelectionEditorProperty, AModeIsWhatTheLeavesGet, ()) {
  std::mt19937 random = *random_source();
  const StructureGraph graph = random_graph(1 + random() % 12, random);
  SelectionEditor editor(graph, std::vector<bool>(graph.size(), true));
  for (int n = 0; n < 5; ++n) {
    const auto s = static_cast<StructureIndex>(random() % graph.size());
    const auto mode = static_cast<DrawMode>(random() % 4);
    std::vector<DrawMode> expected;
    for (const StructureDraw& draw : editor.selection().structures) expected.push_back(draw.mode);
    for (const StructureIndex d : graph.descendants(s)) expected[d] = mode;
    editor.set_mode(s, mode);
    for (StructureIndex d = 0; d < graph.size(); ++d) {
      RC_ASSERT(editor.selection().structures[d].mode == expected[d]);
    }
  }
}

}  // namespace
}  // namespace splatlas
