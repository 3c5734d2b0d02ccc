// Names and trees written by other software. Needs the folder SPLATLAS_TEST_DATA.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/import/tables/read_tree.h"
#include "preprocess/structures/build_graph.h"
#include "tests/preprocess/import/tables/names_cases.h"

namespace splatlas {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Rows of a file; label 0, if the file has one, is not counted.
struct FileCase {
  const char* file;
  NamesFormat dialect;
  std::size_t names;
  std::int64_t label;
  const char* summary;  ///< of this label
  std::int64_t largest;
};

const FileCase kFiles[] = {
    {"names-itksnap/itksnap_Untitled.label", NamesFormat::kItkSnap, 6, 1, "1 Red Label #ff0000", 6},
    {"names-itksnap/brainglobe_dummy_itk_snap_labels.txt", NamesFormat::kItkSnap, 2, 123,
     "123 BrainGlobe (BG) #00ff00", 456},
    {"names-itksnap/quicknii_AllenMouseBrain_CCF_2017.label", NamesFormat::kItkSnap, 1327, 997,
     "997 root #ffffff", 614454277},
    {"names-itksnap/pynutil_allen2015_labels.txt", NamesFormat::kItkSnap, 1287, 997, "997 root #ffffff",
     496345672},
    {"names-slicer/ColorTest.ctbl", NamesFormat::kCtbl, 2, 1, "1 one #ff3b15", 2},
    {"names-slicer/GenericAnatomyColors.txt", NamesFormat::kCtbl, 309, 1, "1 tissue #80ae80", 309},
    {"names-slicer/AbdomenColors.txt", NamesFormat::kCtbl, 91, 7, "7 aorta #ff3215", 700},
    {"names-slicer/PelvisColor.txt", NamesFormat::kCtbl, 23, 5, "5 Vagina #ffe6e1", 23},
    {"names-slicer/Slicer3_2010_Brain_Labels.txt", NamesFormat::kCtbl, 15, 9, "9 Gray matter #d3d3d3", 15},
    {"names-slicer/64Color-Nonsemantic.txt", NamesFormat::kCtbl, 64, 1, "1 light pink #ffcedc", 64},
    {"names-slicer/SlicerRT_Isodose_ColorTable.ctbl", NamesFormat::kCtbl, 5, 5, "5 30 #ff0000", 5},
    {"names-slicer/ColorTest.csv", NamesFormat::kCsv, 3, 5, "5 five #ff3b15", 10},
    {"names-slicer/ColorTestWithTerminology.csv", NamesFormat::kCsv, 4, 1, "1 left_kidney #b9a20d", 10},
    {"names-slicer/ColorTestMissingAlpha.csv", NamesFormat::kCsv, 3, 1, "1 one #0ac828", 10},
    {"names-slicer/ColorTestMissingName.csv", NamesFormat::kCsv, 3, 1, "1 Label 1 #0ac828", 10},
    {"names-slicer/ColorTestInvalidColor.csv", NamesFormat::kCsv, 3, 5, "5 five", 10},
    {"names-freesurfer/FreeSurferColorLUT.txt", NamesFormat::kFreeSurfer, 1790, 17,
     "17 Left-Hippocampus #dcd814", 15137},
    {"names-freesurfer/FastSurfer_ColorLUT.tsv", NamesFormat::kFreeSurfer, 78, 2,
     "2 Left-Cerebral-White-Matter #f5f5f5", 2028},
    {"names-freesurfer/CerebNet_ColorLUT.tsv", NamesFormat::kFreeSurfer, 27, 1, "1 Left_I_IV #4682b4", 27},
    {"names-freesurfer/HypVINN_ColorLUT.txt", NamesFormat::kFreeSurfer, 26, 1, "1 R-N.opticus #4682b4", 229},
    {"names-freesurfer/freesurferformats_colorlut.txt", NamesFormat::kFreeSurfer, 5, 1,
     "1 Left-Cerebral-Exterior #4682b4", 5},
    {"names-bids/tpl-MNI152NLin2009cAsym_atlas-Schaefer2018_desc-100Parcels7Networks_dseg.tsv",
     NamesFormat::kBids, 100, 1, "1 7Networks_LH_Vis_1 #781283", 100},
    {"names-bids/tpl-MNI152NLin2009cAsym_atlas-MIAL67ThalamicNuclei_dseg.tsv", NamesFormat::kBids, 14, 1,
     "1 thal-lh-pulvinar #ff0000", 14},
    {"names-bids/tpl-MNI152NLin2009cAsym_desc-carpet_dseg.tsv", NamesFormat::kBids, 116, 1,
     "1 Left Cerebral White Matter", 255},
    {"names-mricron/AICHAmc.nii.txt", NamesFormat::kMricron, 192, 1, "1 G_Frontal_Sup-1", 192},
    {"names-allen/allen_structure_graph_1.json", NamesFormat::kAllen, 1327, 382, "382 Field CA1 #7ed04b",
     614454277},
    {"names-allen/voxcell_hierarchy.json", NamesFormat::kAllen, 13, 726,
     "726 primary somatosensory cortex, hindlimb region", 1142},
    {"names-allen/pynutil_allen2017_colours.csv", NamesFormat::kCsv, 1327, 184,
     "184 Frontal pole, cerebral cortex #268f45", 614454277},
    {"brainglobe-folder/example_human_4000um_v1.0/structures.json", NamesFormat::kBrainGlobe, 45, 9001,
     "9001 left hemisphere #c8c8c8", 9999},
    {"brainglobe-folder/example_human_4000um_v1.0/structures.csv", NamesFormat::kCsv, 45, 14,
     "14 3rd Ventricle", 9999},
    {"openanatomy-made/atlasStructure.json", NamesFormat::kOpenAnatomy, 9, 41,
     "41 Right Cerebral White Matter #ffffff", 54},
};

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
  for (const FileCase& file : kFiles) {
    SCOPED_TRACE(file.file);
    notes_ = {};
    const NamesTable table = read(std::string("formats/") + file.file);
    EXPECT_EQ(table.dialect, file.dialect);
    EXPECT_EQ(table.names.size(), file.names);
    const LabelName* name = find_label(table.names, file.label);
    ASSERT_TRUE(name);
    EXPECT_EQ(summary(*name), file.summary);
    std::int64_t largest = 0;
    for (const LabelName& each : table.names) largest = std::max(largest, each.label.value_or(0));
    EXPECT_EQ(largest, file.largest);
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
  read("formats/names-bids/tpl-MNI152NLin2009cAsym_desc-carpet_dseg.tsv");
  EXPECT_EQ(count("ignored-columns"), 1u);
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
  const auto placed = build_graph(sources, allen.hierarchy, "allen", notes_);
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(placed->graph.size(), 1327u);
  EXPECT_EQ(placed->graph.roots().size(), 1u);
  EXPECT_EQ(placed->graph.descendants(placed->graph.roots()[0]).size(), 1327u);
}

TEST_F(RealTables, OfBrainGlobeAndOpenAnatomyHaveGraphs) {
  for (const char* file : {"structures.json", "structures.csv"}) {
    const NamesTable table = read(std::string("formats/brainglobe-folder/example_human_4000um_v1.0/") + file);
    const std::vector<SourceStructure> sources(table.names.begin(), table.names.end());
    const auto placed = build_graph(sources, table.hierarchy, "brainglobe", notes_);
    ASSERT_TRUE(placed) << placed.error().message;
    const StructureIndex root = placed->graph.roots()[0];
    EXPECT_EQ(placed->graph.size(), 45u);
    EXPECT_EQ(placed->graph.roots().size(), 1u);
    EXPECT_EQ(placed->graph[root].label, 9999);
    EXPECT_EQ(placed->graph.children(root).size(), 3u);
  }
  const std::string path = test_data() + "/formats/openanatomy-made/atlasStructure.json";
  const auto lines = read_tree(path, notes_);
  ASSERT_TRUE(lines) << lines.error().message;
  const NamesTable table = read("formats/openanatomy-made/atlasStructure.json");
  const std::vector<SourceStructure> sources(table.names.begin(), table.names.end());
  const auto placed = build_graph(sources, *lines, path, notes_);
  ASSERT_TRUE(placed) << placed.error().message;
  EXPECT_EQ(placed->graph.size(), 13u);
  const auto with_two = std::ranges::count_if(placed->graph.structures(),
                                              [](const Structure& s) { return s.parents.size() == 2; });
  EXPECT_EQ(with_two, 4);
  EXPECT_EQ(placed->graph.roots().size(), 1u);
}

}  // namespace
}  // namespace splatlas
