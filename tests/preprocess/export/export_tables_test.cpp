#include "preprocess/export/export_tables.h"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/structures/build_graph.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// Two groups of one name, a structure with two parents, names that need care, codes.
StructureGraph awkward_graph() {
  std::vector<Structure> structures{
      {.id = "Brain", .name = "Brain", .color = {1, 2, 3}},
      {.id = "Left", .name = "Left", .color = {4, 5, 6}, .parents = {0}},
      {.id = "Right", .name = "Right", .color = {7, 8, 9}, .parents = {0}},
      {.id = "Zone_2", .name = "Zone 2", .color = {10, 11, 12}, .parents = {1}},
      {.id = "Zone_2_2", .name = "Zone 2", .color = {13, 14, 15}, .parents = {2}},
      {.id = "a", .name = "area, \"one\"", .color = {255, 0, 128}, .label = 7, .parents = {3}},
      {.id = "b", .name = "white/grey", .color = {0, 255, 1}, .label = 9, .parents = {4, 0}},
      {.id = "c", .name = "lone area", .color = {2, 2, 2}, .label = 4294967295}};
  structures[5].terms = {
      {"SNOMED", "64033007"}, {"synonym", "x"}, {"synonym", "y, z"}, {"de", "Gebiet \"1\""}};
  return StructureGraph::build(std::move(structures)).value();
}

std::vector<SourceStructure> sources_of(const StructureGraph& graph) {
  std::vector<SourceStructure> sources;
  for (const Structure& structure : graph.structures()) {
    if (!structure.label) continue;
    SourceStructure& source = sources.emplace_back();
    source.name = structure.name;
    source.label = structure.label;
  }
  return sources;
}

TEST(NamesText, EveryDialectIsReadAsItself) {
  const TemporaryFolder folder;
  const StructureGraph graph = awkward_graph();
  for (const NamesFormat format :
       {NamesFormat::kCsv, NamesFormat::kItkSnap, NamesFormat::kCtbl, NamesFormat::kFreeSurfer,
        NamesFormat::kBids, NamesFormat::kMricron, NamesFormat::kNiivue}) {
    const std::string file = folder.file("names");
    write_bytes(file, names_text(graph, format).value());
    Notes notes;
    const NamesTable table = value_or_throw(read_names(file, NamesFormat::kAuto, notes));
    EXPECT_EQ(table.dialect, format);
    ASSERT_EQ(table.names.size(), 3u);
    EXPECT_EQ(table.names[2].label, 4294967295);
    if (format == NamesFormat::kCsv) {
      EXPECT_EQ(table.names[0].name, "area, \"one\"");
    }
    for (const LabelName& name : table.names) {
      if (name.label != 9) continue;
      EXPECT_EQ(name.name, "white/grey");
      if (format != NamesFormat::kMricron) {
        EXPECT_EQ(name.color, (Rgb{0, 255, 1}));
      }
    }
  }
}

/// Terms of any vocabulary come back: known ones, languages, qualified codes, others.
TEST(NamesText, CsvHoldsTermsOfEveryVocabulary) {
  const std::vector<Term> terms{{"SNOMED", "1"}, {"de", "Leber"},          {"modifier SNOMED", "7771000"},
                                {"99XYZ", "x"},  {"abbreviation", "Liv."}, {"synonym", "hepar"}};
  const TemporaryFolder folder;
  const StructureGraph graph =
      StructureGraph::build({{.id = "the-liver", .name = "Liver", .label = 3, .terms = terms}}).value();
  write_bytes(folder.file("names.csv"), names_text(graph, NamesFormat::kCsv).value());
  Notes notes;
  const NamesTable table = read_names(folder.file("names.csv"), NamesFormat::kAuto, notes).value();
  ASSERT_EQ(table.names.size(), 1u);
  EXPECT_THAT(table.names[0].terms, testing::UnorderedElementsAreArray(terms));
  EXPECT_EQ(table.names[0].key, "the-liver");
}

TEST(NamesText, NamesOfMasksAreInCsvOnly) {
  const TemporaryFolder folder;
  const StructureGraph masks = StructureGraph::build({{.id = "liver", .name = "liver", .color = {9, 8, 7}},
                                                      {.id = "spleen", .name = "spleen", .color = {1, 2, 3}}})
                                   .value();
  write_bytes(folder.file("names.csv"), names_text(masks, NamesFormat::kCsv).value());
  Notes notes;
  const NamesTable table = read_names(folder.file("names.csv"), NamesFormat::kAuto, notes).value();
  ASSERT_EQ(table.names.size(), 2u);
  EXPECT_EQ(table.names[1].name, "spleen");
  EXPECT_EQ(table.names[1].color, (Rgb{1, 2, 3}));
  EXPECT_FALSE(table.names[1].label);
  EXPECT_THAT(names_text(masks, NamesFormat::kCtbl),
              FailsWith(ErrorCode::kFailed, HasSubstr("only csv holds")));
}

TEST(NamesText, TellsWhatADialectCannotHold) {
  const StructureGraph rich = awkward_graph(),
                       plain = StructureGraph::build({{.id = "a", .name = "a", .label = 1}}).value();
  EXPECT_EQ(losses_of(rich, NamesFormat::kCsv), "");
  EXPECT_EQ(losses_of(rich, NamesFormat::kMricron), "colours, synonyms, languages and codes");
  EXPECT_EQ(losses_of(plain, NamesFormat::kFreeSurfer), "");
}

TEST(NamesText, RefusesDialectsThatAreOnlyRead) {
  EXPECT_THAT(names_text(awkward_graph(), NamesFormat::kAllen),
              FailsWith(ErrorCode::kUsage, HasSubstr("csv, itksnap")));
}

/// Each row has a cell for each vocabulary.
TEST(NamesText, RefusesMoreCellsThanATableHolds) {
  std::vector<Structure> structures;
  for (int n = 0; n < 4200; ++n) {
    const std::string id = fmt::format("s{}", n);
    structures.push_back({.id = id, .name = id, .label = n, .terms = {{"v" + id, "1"}}});
  }
  const StructureGraph graph = StructureGraph::build(std::move(structures)).value();
  EXPECT_THAT(names_text(graph, NamesFormat::kCsv),
              FailsWith(ErrorCode::kLimit, HasSubstr("4200 vocabularies of 4200 structures")));
  EXPECT_TRUE(names_text(graph, NamesFormat::kBids));
}

/// Levels of two groups, each below both of the level above.
StructureGraph ladder(StructureIndex levels) {
  std::vector<Structure> structures;
  for (StructureIndex n = 0; n < 2 * levels; ++n) {
    const std::string id = fmt::format("{:03}", n);
    structures.push_back({.id = id, .name = id});
    if (n >= 2) structures.back().parents = {n / 2 * 2 - 2, n / 2 * 2 - 1};
  }
  return StructureGraph::build(std::move(structures)).value();
}

TEST(TreeText, HasALineForEachPath) {
  const std::string text = tree_text(ladder(10)).value();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2046);  // 2 + 4 + .. + 2^10
}

TEST(TreeText, GivesTheSameGraph) {
  const TemporaryFolder folder;
  const StructureGraph graph = awkward_graph();
  write_bytes(folder.file("tree"), tree_text(graph).value());
  Notes notes;
  const auto lines = value_or_throw(read_tree(folder.file("tree"), notes));
  // Ids follow from names: those of the atlas are found by their labels.
  std::vector<SourceStructure> sources = sources_of(graph);
  sources[1].name = "b";
  const auto placed = value_or_throw(build_graph(sources, lines, "tree", notes));
  EXPECT_TRUE(notes.empty()) << notes.all()[0].message();
  ASSERT_EQ(placed.graph.size(), graph.size());
  const auto paths_of = [&](std::int64_t label) {
    for (StructureIndex s = 0; s < placed.graph.size(); ++s) {
      if (placed.graph[s].label == label) return placed.graph.paths(s);
    }
    return std::vector<std::string>();
  };
  EXPECT_THAT(paths_of(7), testing::ElementsAre("Brain/Left/Zone 2/area, \"one\""));
  EXPECT_THAT(paths_of(9), testing::UnorderedElementsAre("Brain/Right/Zone 2/b", "Brain/b"));
  EXPECT_THAT(paths_of(4294967295), testing::ElementsAre("lone area"));
  for (const Structure& structure : placed.graph.structures()) {
    if (structure.label == 9) {
      EXPECT_EQ(structure.color, (Rgb{0, 255, 1}));
    }
    if (structure.name == "Right") {
      EXPECT_EQ(structure.color, (Rgb{7, 8, 9}));
    }
  }
}

}  // namespace
}  // namespace splatlas
