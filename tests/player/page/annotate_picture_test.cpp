// Layout of annotations: rules in random pictures, and golden positions.
#include "player/page/annotate_picture.h"

#include <gmock/gmock.h>

#include "player/page/place_labels.h"
#include "tests/player/page/label_scene.h"
#include "tests/support/fails_with.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

constexpr AnnotationItems kAllItems{true, true, true, true, true, true};

AnnotationLayer annotated(const AnnotatedScene& scene, const AnnotationOptions& options) {
  auto layer = annotate_picture(scene, options, fixed_width);
  EXPECT_TRUE(layer) << layer.error().message;
  return layer ? *std::move(layer) : AnnotationLayer{};
}

const PlacedText* find_text(const AnnotationLayer& layer, const std::string& words) {
  const auto found = std::ranges::find(layer.texts, words, &PlacedText::text);
  return found == layer.texts.end() ? nullptr : &*found;
}

/// Slow reference: looks at every pixel of the box.
bool covers_structure(const Picture& picture, const PageBox& box) {
  for (int y = std::max(0, static_cast<int>(box.top)); y < std::min<double>(picture.size.height, box.bottom);
       ++y) {
    for (int x = std::max(0, static_cast<int>(box.left)); x < std::min<double>(picture.size.width, box.right);
         ++x) {
      if (picture.at(x, y)[3] > 0) return true;
    }
  }
  return false;
}

std::vector<PlacedLine> leaders(const AnnotationLayer& layer) {
  std::vector<PlacedLine> lines;
  std::ranges::copy_if(layer.lines, std::back_inserter(lines),
                       [](const PlacedLine& one) { return one.casing > 0; });
  return lines;
}

TEST(AnnotatePicture, KeepsTheRulesOfLabels) {
  std::size_t labels = 0;
  for (std::uint32_t seed = 0; seed < repetitions(200); ++seed) {
    SCOPED_TRACE(seed);
    const DiscScene discs = random_discs(seed);
    const AnnotatedScene scene = discs.annotated();
    const AnnotationLayer layer = annotated(scene, {.items = {.labels = true}});
    labels += layer.labels;
    ASSERT_EQ(layer.labels + layer.unlabelled, scene.structures.size());
    ASSERT_EQ(layer.dots.size(), layer.labels);
    const std::vector<PlacedLine> lines = leaders(layer);
    ASSERT_EQ(lines.size(), layer.labels);
    for (std::size_t a = 0; a < lines.size(); ++a) {
      for (std::size_t b = a + 1; b < lines.size(); ++b) {
        EXPECT_FALSE(segments_meet(lines[a].from, lines[a].to, lines[b].from, lines[b].to));
      }
      for (const PlacedText& text : layer.texts) {
        EXPECT_FALSE(segment_meets(lines[a].from, lines[a].to, text.box())) << text.text;
      }
    }
    for (const PlacedText& text : layer.texts) {
      const bool is_note = text.style == FontStyle::kItalic;
      EXPECT_TRUE(is_note || !covers_structure(scene.picture, text.box())) << text.text;
    }
  }
  EXPECT_GT(labels, repetitions(200) * 5u);  // the rules hold with labels, not without them
}

TEST(AnnotatePicture, KeepsTextsInThePictureAndApart) {
  for (std::uint32_t seed = 0; seed < repetitions(200); ++seed) {
    SCOPED_TRACE(seed);
    const DiscScene discs = random_discs(seed);
    const AnnotatedScene scene = discs.annotated();
    const auto layer = annotate_picture(
        scene, {kAllItems, 40, "A caption of several words", "Someone et al. (2004)"}, fixed_width);
    if (!layer) continue;  // too small; see RefusesPicturesThatAreTooSmall
    const PageBox page{0, 0, 1.0 * scene.picture.size.width, 1.0 * scene.picture.size.height};
    for (const PlacedText& text : layer->texts) {
      EXPECT_TRUE(contains(page, text.box())) << text.text;
      for (const PlacedText& other : layer->texts) {
        if (&text >= &other) continue;
        EXPECT_FALSE(overlap(text.box(), other.box())) << text.text << other.text;
      }
      for (const PlacedLine& line : leaders(*layer)) {
        EXPECT_FALSE(segment_meets(line.from, line.to, text.box())) << text.text;
      }
    }
  }
}

/// Discs all over the region that annotations leave to structures.
DiscScene discs_in(const PictureRegion& region, const PictureSize& size, std::size_t discs,
                   std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto within = [&](double from, double to) {
    return from + (to - from) * std::generate_canonical<double, 32>(random);
  };
  DiscScene scene(size);
  const double left = region.left * size.width, right = region.right * size.width,
               top = region.top * size.height, bottom = region.bottom * size.height;
  const double radius = 0.06 * std::min(right - left, bottom - top);
  for (std::size_t n = 0; n < discs; ++n) {
    const double x = within(left + radius, right - radius);  // before y with any compiler
    scene.add(static_cast<StructureIndex>(n), x, within(top + radius, bottom - radius), radius);
  }
  return scene;
}

TEST(AnnotatePicture, FindsRoomBesideTheRegionOfItsFigure) {
  std::size_t labels = 0, structures = 0;
  for (std::uint32_t seed = 0; seed < repetitions(80); ++seed) {
    SCOPED_TRACE(seed);
    const PictureSize size{700 + static_cast<int>(seed * 37 % 500), 700 + static_cast<int>(seed * 61 % 500)};
    const AnnotationOptions options{kAllItems, 40, "A caption of several words", "Someone et al. (2004)"};
    const std::size_t discs = 1 + seed % 12;
    // Names and areas are known before the picture
    const DiscScene names = discs_in({}, size, discs, seed);
    const Picture blank{size, {}};
    AnnotatedScene blank_scene{blank, names.annotated().view, Rgb{0, 0, 0}, names.annotated().structures};
    const PictureRegion region = region_of_figure(blank_scene, options, fixed_width);
    ASSERT_LT(region.left, region.right);
    ASSERT_LT(region.top, region.bottom);

    const DiscScene scene = discs_in(region, size, discs, seed);
    const AnnotationLayer layer = annotated(scene.annotated(), options);
    for (const std::string& note : layer.notes) EXPECT_THAT(note, HasSubstr("scale bar"));
    labels += layer.labels;
    structures += scene.annotated().structures.size();
  }
  EXPECT_GT(labels, structures * 9 / 10);
}

TEST(AnnotatePicture, LeavesThePictureToStructuresWithoutItems) {
  const DiscScene discs = random_discs(1);
  EXPECT_EQ(region_of_figure(discs.annotated(), {}, fixed_width), PictureRegion());
  EXPECT_TRUE(annotated(discs.annotated(), {}).texts.empty());
  // A tiny picture keeps a fifth of its sides
  const Picture tiny{{20, 20}, {}};
  const AnnotatedScene scene{tiny, discs.annotated().view, Rgb{0, 0, 0}, discs.annotated().structures};
  const PictureRegion region =
      region_of_figure(scene, {kAllItems, 40, "A caption", "A citation"}, fixed_width);
  EXPECT_GE(region.left, 0);
  EXPECT_GE(region.top, 0);
  EXPECT_LE(region.right, 1);
  EXPECT_LE(region.bottom, 1);
  EXPECT_NEAR(region.right - region.left, 0.2, 1e-12);
  EXPECT_NEAR(region.bottom - region.top, 0.2, 1e-12);
}

TEST(AnnotatePicture, PlacesLabelsBesideTheirStructures) {
  DiscScene discs({600, 600});
  discs.add(0, 250, 300, 40);
  discs.add(1, 350, 300, 40);
  const AnnotationLayer layer = annotated(discs.annotated(), {.items = {.labels = true}});
  const PlacedText* left = find_text(layer, "Structure number 0");
  const PlacedText* right = find_text(layer, "Structure number 1");
  ASSERT_TRUE(left && right);
  // 600 pixels are 160 mm: 1.32 pixels per point. Labels of 8.5 points begin 12 points beside the discs.
  const double pt = 600 / (160 / 25.4) / 72;
  EXPECT_NEAR(left->size, 8.5 * pt, 1e-9);
  EXPECT_NEAR(left->x + left->width, 210 - 12 * pt, 1e-9);
  EXPECT_NEAR(right->x, 390 + 12 * pt, 1e-9);
  // Half the distance of two positions, and the fan of anchors half a pixel beside the centre.
  const double middle = 0.5 * (left->box().top + left->box().bottom);
  EXPECT_NEAR(middle, 300, 0.5 * 1.17 * left->size / 4 + 1.15 * 0.5);
  EXPECT_EQ(left->y, right->y);
  EXPECT_EQ(layer.unlabelled, 0u);
}

TEST(AnnotatePicture, CountsWhatIsNotLabelledUnlessALimitIsGiven) {
  DiscScene discs({600, 400});
  for (StructureIndex n = 0; n < 45; ++n) discs.add(n, 100 + 40.0 * (n % 11), 50 + 60.0 * (n / 11), 12);
  const AnnotationLayer layer = annotated(discs.annotated(), {.items = {.labels = true}});
  EXPECT_GE(layer.unlabelled, 5u);
  EXPECT_TRUE(find_text(layer, std::to_string(layer.unlabelled) + " more structures are not labelled."));
  const AnnotationLayer two = annotated(discs.annotated(), {.items = {.labels = true}, .max_labels = 2});
  EXPECT_EQ(two.labels, 2u);
  EXPECT_TRUE(
      std::ranges::none_of(two.texts, [](const PlacedText& one) { return one.style == FontStyle::kItalic; }));
}

TEST(AnnotatePicture, LabelsEveryDiscOfAGridWithRoom) {
  DiscScene discs({1200, 900});
  for (StructureIndex n = 0; n < 30; ++n) discs.add(n, 270 + 132.0 * (n % 6), 110 + 165.0 * (n / 6), 45);
  EXPECT_EQ(annotated(discs.annotated(), {.items = {.labels = true}}).labels, 30u);
}

TEST(AnnotatePicture, PutsNamesOnFaintHullsThatLeaveNoRoom) {
  DiscScene discs({600, 400});
  discs.add(0, 300, 200, 60);
  for (std::size_t n = 3; n < discs.picture.rgba.size(); n += 4)
    discs.picture.rgba[n] = std::max(discs.picture.rgba[n], 0.24f);
  EXPECT_EQ(annotated(discs.annotated(), {.items = {.labels = true}}).labels, 1u);
}

TEST(AnnotatePicture, LabelsAsManyBesideWhatTheCaptionCovers) {
  DiscScene discs({600, 400});
  for (StructureIndex n = 0; n < 2; ++n) discs.add(n, 200 + 200 * n, 390, 20);  // the largest
  for (StructureIndex n = 2; n < 5; ++n) discs.add(n, 200 + 40 * n, 150, 10 + n);
  const AnnotationLayer layer = annotated(
      discs.annotated(), {.items = {.labels = true, .caption = true}, .max_labels = 2, .caption = "Discs"});
  EXPECT_EQ(layer.labels, 2u);
}

TEST(AnnotatePicture, ListsWhatHasNoLabel) {
  DiscScene discs({600, 400});
  for (StructureIndex n = 0; n < 5; ++n) discs.add(n, 220 + 40 * n, 200, 10 + n);
  const AnnotationLayer layer =
      annotated(discs.annotated(), {.items = {.labels = true, .legend = true}, .max_labels = 2});
  EXPECT_EQ(layer.labels, 2u);
  EXPECT_EQ(layer.legend_entries, 3u);
  for (int n = 0; n < 5; ++n)
    EXPECT_TRUE(find_text(layer, "Structure number " + std::to_string(n))) << n;  // each once
  EXPECT_EQ(layer.texts.size(), 5u);
}

TEST(AnnotatePicture, DrawsAScaleBarOfExactLength) {
  DiscScene discs({800, 400});
  discs.add(0, 400, 200, 50);
  AnnotatedScene scene = discs.annotated();  // 0.25 mm per pixel: a fifth of the width is 40 mm
  const AnnotationLayer layer = annotated(scene, {.items = {.scale_bar = true}});
  ASSERT_EQ(layer.lines.size(), 3u);
  EXPECT_NEAR(layer.lines[0].to.x - layer.lines[0].from.x, 80, 1e-9);
  EXPECT_NEAR(layer.lines[0].to.x, 800 - 0.035 * 400, 1e-9);
  EXPECT_TRUE(find_text(layer, "20 mm"));
  scene.view.eye_mm = 500;
  EXPECT_TRUE(find_text(annotated(scene, {.items = {.scale_bar = true}}), "20 mm at the centre"));
}

TEST(AnnotatePicture, TextIsLegibleOnBothEndsOfAGradient) {
  DiscScene discs({600, 400});
  AnnotatedScene scene = discs.annotated();
  for (const bool upwards : {false, true}) {
    scene.background = upwards ? Rgb{250, 250, 250} : Rgb{10, 10, 10};
    scene.background_bottom = upwards ? Rgb{10, 10, 10} : Rgb{250, 250, 250};
    const AnnotationLayer layer =
        annotated(scene, {.items = {.orientation = true, .citation = true}, .citation = "X"});
    for (const PlacedText& text : layer.texts) {
      const double share = text.y / 400;
      if (share > 0.3 && share < 0.7) continue;
      EXPECT_EQ(text.color.r > 128, upwards == (share > 0.5)) << text.text;
    }
  }
}

TEST(AnnotatePicture, NamesTheDirectionsOfTheEdges) {
  DiscScene discs({600, 400});
  const AnnotationLayer layer = annotated(discs.annotated(), {.items = {.orientation = true}});
  ASSERT_EQ(layer.texts.size(), 4u);  // left, right, top, bottom
  EXPECT_EQ(layer.texts[0].text + layer.texts[1].text + layer.texts[2].text + layer.texts[3].text, "RLSI");
  EXPECT_LT(layer.texts[0].x, 50);
  EXPECT_GT(layer.texts[1].x, 550);
  EXPECT_LT(layer.texts[2].y, 50);
  EXPECT_GT(layer.texts[3].y, 350);
}

TEST(AnnotatePicture, ListsEveryStructureOrTheirNumber) {
  DiscScene discs({600, 400});
  for (StructureIndex n = 0; n < 7; ++n) discs.add(n, 100 + 40 * n, 100, 15);
  const AnnotationLayer layer = annotated(discs.annotated(), {.items = {.legend = true}});
  EXPECT_EQ(layer.legend_entries, 7u);
  EXPECT_EQ(layer.boxes.size(), 14u);  // with outlines
  EXPECT_TRUE(layer.notes.empty());

  DiscScene many({600, 400});
  for (StructureIndex n = 0; n < 200; ++n) many.add(n, 10 + 20.0 * (n % 29), 10 + 15.0 * (n / 29), 6);
  const AnnotationLayer cut = annotated(many.annotated(), {.items = {.legend = true}});
  EXPECT_LT(cut.legend_entries, 200u);
  EXPECT_TRUE(find_text(cut, "and " + std::to_string(200 - cut.legend_entries) + " more"));
}

TEST(AnnotatePicture, ReportsItemsThatCoverStructures) {
  DiscScene discs({600, 400});
  discs.add(0, 300, 200, 400);
  const AnnotationLayer layer = annotated(discs.annotated(), {{.caption = true}, 40, "Caption"});
  ASSERT_EQ(layer.notes.size(), 1u);
  EXPECT_THAT(layer.notes[0], HasSubstr("caption covers structures"));
  EXPECT_EQ(layer.boxes.size(), 1u);  // a plate
}

TEST(AnnotatePicture, HasTextsOfAtLeastSevenPointsInPrint) {
  DiscScene discs({2480, 1754});
  discs.add(0, 1240, 600, 300);
  const AnnotationLayer layer = annotated(discs.annotated(), {kAllItems, 0, "Caption", "Citation", 300.0});
  for (const PlacedText& text : layer.texts) EXPECT_GE(text.size, 7 * 300 / 72.0 - 1e-9) << text.text;
}

TEST(AnnotatePicture, RefusesPicturesThatAreTooSmall) {
  DiscScene discs({60, 40});
  discs.add(0, 30, 20, 5);
  EXPECT_THAT(annotate_picture(discs.annotated(), {kAllItems, 40, "Caption", "Citation"}, fixed_width),
              FailsWith(ErrorCode::kUsage, HasSubstr("picture size 60x40: too small")));
}

/// Words of hostile files have any length.
TEST(WrapText, MeasuresEachLetterAFewTimes) {
  std::size_t measured = 0;
  const auto width = [&](std::string_view text) {
    measured += text.size();
    return static_cast<double>(text.size());
  };
  const std::string word(20000, 'i');
  EXPECT_EQ(wrap_text(word, 100, width), std::vector<std::string>(200, std::string(100, 'i')));
  EXPECT_LT(measured, 20 * word.size());
  EXPECT_EQ(wrap_text("\xc3\xb6\xc3\xb6\xc3\xb6", 3, width), std::vector<std::string>(3, "\xc3\xb6"));
}

}  // namespace
}  // namespace splatlas
