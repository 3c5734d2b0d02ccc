// Names and trees written by other software. Needs the folder SPLATLAS_TEST_DATA.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/names_table.h"
#include "preprocess/structures/build_graph.h"
#include "tests/preprocess/import/tables/names_cases.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

/// File, dialect, names, a label, its summary, and the largest label, a line each; label 0 is not counted.
constexpr std::string_view kFiles =
#include "tests/preprocess/import/tables/real_tables.txt"
    ;

class RealTables : public testing::Test {
 protected:
  void SetUp() override {
    if (test_data().empty()) GTEST_SKIP() << "SPLATLAS_TEST_DATA is not set";
  }
  NamesTable read(const std::string& file) {
    auto table = read_names(test_data() + "/" + file, NamesFormat::kAuto, notes_);
    if (!table) ADD_FAILURE() << table.error().message;
    return table.value_or(NamesTable{});
  }
  std::string error(const std::string& file) {
    const auto table = read_names(test_data() + "/" + file, NamesFormat::kAuto, notes_);
    return table ? "no error" : table.error().message;
  }
  [[nodiscard]] std::size_t count(const std::string& kind) const {
    for (const Note& note : notes_.all()) {
      if (note.kind == kind) return note.items.size();
    }
    return 0;
  }
  Notes notes_;
};

TEST_F(RealTables, HaveTheirNamesAndColours) {
  for (const std::string_view line : split(kFiles, '\n')) {
    SCOPED_TRACE(line);
    const std::vector<std::string_view> parts = split(line, '|');
    notes_ = {};
    const NamesTable table = read("formats/" + std::string(parts[0]));
    EXPECT_EQ(std::ranges::find(names_formats(), table.dialect, &NamesFormatInfo::format)->option, parts[1]);
    EXPECT_EQ(table.names.size(), parse_number<std::size_t>(parts[2]));
    const LabelName* name = find_label(table.names, parse_number<std::int64_t>(parts[3]).value());
    ASSERT_TRUE(name);
    EXPECT_EQ(summary(*name), parts[4]);
    std::int64_t largest = 0;
    for (const LabelName& each : table.names) largest = std::max(largest, each.label.value_or(0));
    EXPECT_EQ(largest, parse_number<std::int64_t>(parts[5]));
    EXPECT_EQ(count("faulty-rows"), 0u);
    EXPECT_EQ(count("duplicate-labels"), 0u);
  }
}

TEST_F(RealTables, TellWhatIsOdd) {
  read("formats/names-slicer/ColorTestInvalidColor.csv");
  EXPECT_EQ(count("bad-colors"), 1u);
  read("formats/names-slicer/ColorTestMissingName.csv");
  EXPECT_EQ(count("missing-names"), 3u);
  notes_ = {};
  const NamesTable lut = read("formats/names-freesurfer/FreeSurferColorLUT.txt");
  std::set<std::string> colors{"#000000"};  // of label 0
  for (const LabelName& name : lut.names) colors.insert(to_hex(name.color.value_or(Rgb{})));
  EXPECT_EQ(colors.size(), 803u);
  EXPECT_EQ(find_label(lut.names, 53)->color, (Rgb{220, 216, 20}));
  EXPECT_EQ(find_label(lut.names, 902)->name, "Artery");
}

TEST_F(RealTables, AreRefusedWithAReason) {
  EXPECT_THAT(error("formats/names-slicer/ColorTestMissingLabelValue.csv"),
              HasSubstr("LabelValue is missing"));
  EXPECT_THAT(error("formats/names-slicer/ColorTestMissingColor.csv"),
              HasSubstr("2 of the three colour columns"));
  for (const char* ramp : {"Blues", "batlow", "fake_parula", "inferno"})
    EXPECT_THAT(error(std::string("formats/names-niivue/") + ramp + ".json"), HasSubstr("is a colour ramp"));
  EXPECT_THAT(error("formats/names-bids/tpl-MNI152NLin2009cAsym_atlas-MIAL67ThalamicNuclei_dseg.json"),
              HasSubstr("JSON class map"));
}

TEST_F(RealTables, HaveTermsOfTerminologies) {
  const NamesTable slicer = read("formats/names-slicer/ColorTestWithTerminology.csv");
  EXPECT_THAT(slicer.names[0].terms,
              ElementsAre(Term{"category SNOMED", "123037004"}, Term{"SNOMED", "64033007"},
                          Term{"modifier SNOMED", "7771000"}));
  const NamesTable table = read("totalseg/totalsegmentator_snomed_mapping.csv");
  ASSERT_EQ(table.names.size(), 170u);
  EXPECT_EQ(summary(table.names[2]), "aorta #d86c36");
  EXPECT_THAT(table.names[2].terms,
              ElementsAre(Term{"category SNOMED", "123037004"}, Term{"SNOMED", "15825003"}));
}

TEST_F(RealTables, HaveHierarchies) {
  const NamesTable allen = read("formats/names-allen/allen_structure_graph_1.json");
  ASSERT_EQ(allen.hierarchy.size(), 1327u);
  std::set<std::string> parents;
  for (const TreeLine& line : allen.hierarchy) {
    if (!line.node->parents.empty()) parents.insert(line.node->parents.front());
    if (line.node->label == 382) {
      EXPECT_THAT(line.node->parents, ElementsAre("id:375"));
    }
  }
  EXPECT_EQ(1327u - parents.size(), 1038u);  // leaves
  std::vector<SourceStructure> sources(allen.names.begin(), allen.names.end());
  const auto placed = value_or_throw(build_graph(sources, allen.hierarchy, "allen", notes_));
  EXPECT_EQ(placed.graph.size(), 1327u);
  EXPECT_EQ(placed.graph.roots().size(), 1u);
  EXPECT_EQ(placed.graph.descendants(placed.graph.roots()[0]).size(), 1327u);
}

TEST_F(RealTables, OfBrainGlobeAndOpenAnatomyHaveGraphs) {
  for (const char* file : {"structures.json", "structures.csv"}) {
    const NamesTable table = read(std::string("formats/brainglobe-folder/example_human_4000um_v1.0/") + file);
    const std::vector<SourceStructure> sources(table.names.begin(), table.names.end());
    const auto placed = value_or_throw(build_graph(sources, table.hierarchy, "brainglobe", notes_));
    const StructureIndex root = placed.graph.roots()[0];
    EXPECT_EQ(placed.graph.size(), 45u);
    EXPECT_EQ(placed.graph.roots().size(), 1u);
    EXPECT_EQ(placed.graph[root].label, 9999);
    EXPECT_EQ(placed.graph.children(root).size(), 3u);
  }
  const std::string path = test_data() + "/formats/openanatomy-made/atlasStructure.json";
  const auto lines = value_or_throw(read_tree(path, notes_));
  const NamesTable table = read("formats/openanatomy-made/atlasStructure.json");
  const std::vector<SourceStructure> sources(table.names.begin(), table.names.end());
  const auto placed = value_or_throw(build_graph(sources, lines, path, notes_));
  EXPECT_EQ(placed.graph.size(), 13u);
  const auto with_two = std::ranges::count_if(placed.graph.structures(),
                                              [](const Structure& s) { return s.parents.size() == 2; });
  EXPECT_EQ(with_two, 4);
  EXPECT_EQ(placed.graph.roots().size(), 1u);
}

}  // namespace
}  // namespace splatlas
