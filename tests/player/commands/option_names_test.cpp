#include "player/commands/option_names.h"

#include <gmock/gmock.h>

namespace splatlas {
namespace {

TEST(OptionNames, OfViews) {
  EXPECT_EQ(named_view("anterior"), NamedView::kAnterior);
  EXPECT_EQ(named_view("posterior"), NamedView::kPosterior);
  EXPECT_EQ(named_view("left"), NamedView::kLeft);
  EXPECT_EQ(named_view("right"), NamedView::kRight);
  EXPECT_EQ(named_view("superior"), NamedView::kSuperior);
  EXPECT_EQ(named_view("inferior"), NamedView::kInferior);
  EXPECT_FALSE(named_view("Anterior"));
  EXPECT_FALSE(named_view("front"));
  EXPECT_FALSE(named_view(""));
}

TEST(OptionNames, OfProjections) {
  EXPECT_EQ(named_projection("parallel"), CameraProjection::kParallel);
  EXPECT_EQ(named_projection("perspective"), CameraProjection::kPerspective);
  EXPECT_FALSE(named_projection("Perspective"));
}

TEST(OptionNames, OfQualities) {
  EXPECT_EQ(named_quality("draft"), Quality::kDraft);
  EXPECT_EQ(named_quality("normal"), Quality::kNormal);
  EXPECT_EQ(named_quality("high"), Quality::kHigh);
  EXPECT_FALSE(named_quality("High"));
  EXPECT_FALSE(named_quality(""));
}

TEST(OptionNames, OfDepthCues) {
  EXPECT_EQ(named_depth_cue("none"), DepthCue::kNone);
  EXPECT_EQ(named_depth_cue("edges"), DepthCue::kEdges);
  EXPECT_FALSE(named_depth_cue("Edges"));
}

}  // namespace
}  // namespace splatlas
