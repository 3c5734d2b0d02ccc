// Dialects in JSON: NiiVue, Allen, BrainGlobe, Open Anatomy and class maps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/import/tables/names_cases.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

class JsonDialects : public NamesTest {};

TEST_F(JsonDialects, ReadsNiivue) {
  EXPECT_THAT(summaries(names(R"({"R":[0,255,1],"G":[0,0,2],"B":[0,128,3],"I":[0,17,4294967295],
                                 "labels":["air","Left Hippocampus"]})",
                              NamesFormat::kNiivue)),
              ElementsAre("17 Left Hippocampus #ff0080", "4294967295 Label 4294967295 #010203"));
  EXPECT_THAT(
      summaries(names(R"({"R":[0,2],"G":[0,2],"B":[0,2],"labels":["air","A"]})", NamesFormat::kNiivue)),
      ElementsAre("1 A #020202"));
  EXPECT_THAT(error(R"({"R":[0],"G":[0],"B":[0],"A":[0],"I":[255]})"), HasSubstr("it is a colour ramp"));
}

TEST_F(JsonDialects, ReadsClassMaps) {
  EXPECT_THAT(summaries(names(R"({"0": "background", "1": "spleen", "2": "liver"})", NamesFormat::kJson)),
              ElementsAre("1 spleen", "2 liver"));
  EXPECT_THAT(summaries(names(R"({"labels": {"background": 0, "spleen": 1}})", NamesFormat::kJson)),
              ElementsAre("1 spleen"));
  EXPECT_THAT(
      summaries(names(R"([{"label": 1, "name": "liver", "color": "#cc331a"}, {"label": 2, "name": "heart"}])",
                      NamesFormat::kJson)),
      ElementsAre("1 liver #cc331a", "2 heart"));
  EXPECT_THAT(summaries(names(R"({"1": {"name": "liver", "color": [204, 51, 26]}, "2": {"name": "heart"}})",
                              NamesFormat::kJson)),
              ElementsAre("1 liver #cc331a", "2 heart"));
  EXPECT_THAT(error("{\"a\": \"b\", }"), HasSubstr("byte 12 is no JSON; correct it"));
  EXPECT_THAT(error("[1, 2]"), HasSubstr("is no map of labels and names"));
}

TEST_F(JsonDialects, ReadsAllensGraph) {
  const std::string bare = R"({"id": 997, "acronym": "root", "name": "root", "children": [
      {"id": 8, "name": "grey, all", "color_hex_triplet": "BFDAE3", "children": [
        {"id": 614454277, "acronym": "SSs", "name": "area", "children": []}]}]})";
  for (const std::string& text : {bare, "{\"success\": true, \"msg\": [" + bare + "]}"}) {
    const auto table = value_or_throw(read(text));
    EXPECT_EQ(table.dialect, NamesFormat::kAllen);
    EXPECT_THAT(summaries(table.names), ElementsAre("997 root", "8 grey, all #bfdae3", "614454277 area"));
    ASSERT_EQ(table.hierarchy.size(), 3u);
    EXPECT_THAT(table.hierarchy[0].node->parents, IsEmpty());
    EXPECT_THAT(table.hierarchy[2].node->parents, ElementsAre(table.hierarchy[1].node->key));
  }
  EXPECT_THAT(error("{\"msg\": \"failed\", \"id\": 0, \"children\": 1}"), HasSubstr("holds no structures"));
}

/// Groups of trees such as siibra's have names alone.
TEST_F(JsonDialects, ReadsGroupsWithoutIds) {
  const auto table =
      read(R"({"name": "Body", "children": [{"name": "Thorax", "children": [{"name": "heart", "id": 2}]},
                                                            {"name": "spine", "id": 3}]})");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(summaries(table->names), ElementsAre("2 heart", "3 spine"));
  ASSERT_EQ(table->hierarchy.size(), 4u);
  EXPECT_THAT(table->hierarchy[1].node->parents, ElementsAre(table->hierarchy[0].node->key));
  EXPECT_THAT(table->hierarchy[2].node->parents, ElementsAre(table->hierarchy[1].node->key));
  EXPECT_THAT(table->hierarchy[3].node->parents, ElementsAre(table->hierarchy[0].node->key));
}

TEST_F(JsonDialects, ReadsDcmqi) {
  const auto list = names(R"({"ContentCreatorName": "Reader1", "segmentAttributes": [[{"labelID": 1,
      "SegmentDescription": "liver", "recommendedDisplayRGBValue": [204, 51, 26], "SegmentedPropertyTypeCodeSequence":
      {"CodeValue": "10200004", "CodingSchemeDesignator": "SCT"}}], [{"labelID": 2, "SegmentLabel": "heart"}]]})",
                          NamesFormat::kDcmqi);
  EXPECT_THAT(summaries(list), ElementsAre("1 liver #cc331a", "2 heart"));
  EXPECT_THAT(list[0].terms, ElementsAre(Term{"SNOMED", "10200004"}));
}

/// The header's root stays above a member that names it again, wherever it stands in the file.
TEST_F(JsonDialects, PutsRootsOfOpenAnatomyFirst) {
  const auto table =
      read(R"([{"@id": "t", "@type": "Group", "annotation": {"name": "Thorax"}, "member": ["s", "b"]},
    {"@id": "b", "@type": "Group", "annotation": {"name": "Body"}, "member": ["t"]},
    {"@id": "h", "@type": "Header", "root": ["b"]},
    {"@id": "s", "@type": "Structure", "annotation": {"name": "heart"},
     "sourceSelector": {"@type": "LabelMapSelector", "dataKey": 1}}])");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->hierarchy[0].node->name, "Body");
}

TEST_F(JsonDialects, TellsKeysFromValues) {
  const std::string text =
      R"({"id": 1, "name": "R", "acronym" : "G", "children" : [{"id": 2, "name": "B"}]})";
  EXPECT_THAT(summaries(names(text, NamesFormat::kAllen)), ElementsAre("1 R", "2 B"));
}

TEST_F(JsonDialects, ReadsBrainGlobe) {
  const auto table =
      value_or_throw(read(R"([{"acronym": "root", "id": 9999, "name": "root", "structure_id_path": [9999],
                              "rgb_triplet": [255, 255, 254]},
                             {"acronym": "A", "id": 2, "name": "a", "structure_id_path": [9999, 2]}, 5])"));
  EXPECT_EQ(table.dialect, NamesFormat::kBrainGlobe);
  EXPECT_THAT(summaries(table.names), ElementsAre("9999 root #fffffe", "2 a"));
  EXPECT_THAT(table.hierarchy[1].node->parents, ElementsAre("id:9999"));
  EXPECT_THAT(items("faulty-rows"), ElementsAre("names.txt entry 3: is no object"));
}

TEST_F(JsonDialects, ReadsOpenAnatomy) {
  const auto table = value_or_throw(read(R"([{"@id": "h", "@type": "Header", "root": "g"},
    {"@id": "g", "@type": "Group", "annotation": {"name": "brain"}, "member": ["s", "t"]},
    {"@id": "l", "@type": ["Group"], "annotation": {"name": "limbic"},
     "member": ["s", {"@type": "Structure", "annotation": {"name": "inline"}}]},
    {"@id": "s", "@type": "Structure", "annotation": {"name": "Left"}, "renderOption": {"color": "orange"},
     "sourceSelector": [{"@type": "geometrySelector"},
                        {"@type": ["Selector", "labelMapSelector"], "dataKey": "17"}]},
    {"@id": "t", "@type": "Structure", "annotation": {"name": "Right"}, "renderOption": {"color": "nocolor"},
     "sourceSelector": {"@type": ["Selector", "labelMapSelector"], "dataKey": 53}}])"));
  EXPECT_EQ(table.dialect, NamesFormat::kOpenAnatomy);
  EXPECT_THAT(summaries(table.names), ElementsAre("inline", "17 Left #ffa500", "53 Right"));
  ASSERT_EQ(table.hierarchy.size(), 5u);
  EXPECT_THAT(table.hierarchy[3].node->parents, ElementsAre("g", "l"));
  EXPECT_THAT(items("bad-colors"), ElementsAre(HasSubstr("nocolor")));
}

}  // namespace
}  // namespace splatlas
