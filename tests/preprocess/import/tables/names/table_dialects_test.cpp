// Dialects of tables: BIDS, CSV and TSV.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/import/tables/names_cases.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

class TableDialects : public NamesTest {};

TEST_F(TableDialects, ReadsBids) {
  EXPECT_THAT(summaries(names("index\tname\tabbreviation\tcolor\tnetwork\r\n0\tbackground\tn/a\tn/a\t1\r\n"
                              "1\tLeft White Matter\tlwm\t#781283\t35, 58, 48\r\n255\tx\tn/a\tn/a\tn/a",
                              NamesFormat::kBids)),
              ElementsAre("1 Left White Matter #781283", "255 x"));
  EXPECT_THAT(items("ignored-columns"), ElementsAre("\"network\""));
  EXPECT_THAT(summaries(names("index\tname\txyz\n1\tA\t35, 58, 48\n", NamesFormat::kBids)),
              ElementsAre("1 A"));
}

TEST_F(TableDialects, ReadsColumnsByName) {
  EXPECT_THAT(summaries(names("LabelValue,Name,Color_R,Color_G,Color_B,Color_A\n1,one,10,200,40,255\n",
                              NamesFormat::kCsv)),
              ElementsAre("1 one #0ac828"));
  EXPECT_THAT(items("ignored-columns"), IsEmpty());
  EXPECT_THAT(summaries(names("hex;STRUCTURE;Id\nff0000;A;3\n#0F0;B;4.0\n", NamesFormat::kCsv)),
              ElementsAre("3 A #ff0000", "4 B #00ff00"));
  EXPECT_THAT(summaries(names("index,label\n1,spleen\n2,liver\n", NamesFormat::kCsv)),
              ElementsAre("1 spleen", "2 liver"));
  EXPECT_THAT(
      summaries(names("name,value,rgb\nA,1,\"1,2,3\"\nB,2,\"rgba(4, 5, 6, 0.5)\"\n", NamesFormat::kCsv)),
      ElementsAre("1 A #010203", "2 B #040506"));
}

TEST_F(TableDialects, ReadsQuotedFields) {
  EXPECT_THAT(summaries(names("\xef\xbb\xbfidx,name\r\n1,\"Frontal pole, layer 1\"\r\n2,\"the \"\"inner\"\" "
                              "part\"\r\n3 , \"x\" \r\n4,A \"B\"",
                              NamesFormat::kCsv)),
              ElementsAre("1 Frontal pole, layer 1", "2 the \"inner\" part", "3 x", "4 A \"B\""));
  EXPECT_EQ(names("id,name\n1,\"open\n2,B\n", NamesFormat::kCsv).size(), 1u);
  EXPECT_THAT(items("faulty-rows"), ElementsAre("names.txt line 2: a quote has no end; add it"));
}

TEST_F(TableDialects, CountsRowsWithTooManyFields) {
  EXPECT_EQ(names("id,name\n1,A,\n2,B, C\n3\n", NamesFormat::kCsv).size(), 2u);
  EXPECT_THAT(items("faulty-rows"), ElementsAre(HasSubstr("line 3: has 3 fields, the header 2")));
  EXPECT_THAT(items("missing-names"), ElementsAre("3 (names.txt line 4)"));
}

TEST_F(TableDialects, ReadsTablesWithoutAHeader) {
  EXPECT_THAT(summaries(names("1,spleen\r\n2,\"kidney, right\"", NamesFormat::kCsv)),
              ElementsAre("1 spleen", "2 kidney, right"));
  EXPECT_THAT(summaries(names("1;spleen;#ff0000\n", NamesFormat::kCsv)), ElementsAre("1 spleen #ff0000"));
  EXPECT_THAT(summaries(names("1,spleen,1,2,3\n2,x,4,5,6\n", NamesFormat::kCsv)),
              ElementsAre("1 spleen #010203", "2 x #040506"));
}

TEST_F(TableDialects, FindsColumnsByTheirValues) {
  EXPECT_THAT(summaries(names("Nummer;Name;Rot;Grün;Blau\n9;Leber;204;51;26\n", NamesFormat::kCsv)),
              ElementsAre("9 Leber #cc331a"));
  EXPECT_THAT(summaries(names("ROI,Region Name,Side\n1,liver,R\n2,heart,R\n", NamesFormat::kCsv)),
              ElementsAre("1 liver", "2 heart"));
  EXPECT_THAT(
      summaries(names("Region,RegionName,Shown as\n7,liver,#ff0000\n9,heart,#00f\n", NamesFormat::kCsv)),
      ElementsAre("7 liver #ff0000", "9 heart #0000ff"));
  EXPECT_THAT(summaries(names("No_,name,Volume\n1,liver,12\n2,heart,15\n", NamesFormat::kCsv)),
              ElementsAre("1 liver", "2 heart"));
  EXPECT_THAT(summaries(names("id,name\n1,17\n2,18\n", NamesFormat::kCsv)), ElementsAre("1 17", "2 18"));
  EXPECT_THAT(
      summaries(names("1,spleen,1,0,9\n2,liver,2,5,9\n2,liver again,3,9,7\n3,4,1,2,3\n", NamesFormat::kCsv)),
      ElementsAre("1 spleen #010009", "2 liver #020509", "3 4 #010203"));
  EXPECT_EQ(items("duplicate-labels").size(), 1u);
  const auto two = value_or_throw(read("No_,name,Volume\n5,liver,12\n7,heart,15\n", NamesFormat::kCsv));
  EXPECT_FALSE(two.names[0].label);
  EXPECT_THAT(two.columns, ElementsAre("No_", "name", "Volume"));
  EXPECT_THAT(summaries(names("spleen;0.5;1;0;5\nliver;0;0;1;3\n", NamesFormat::kCsv)),
              ElementsAre("5 spleen #80ff00", "3 liver #0000ff"));
}

/// Latin-1's 0xe9 is U+00E9. UTF-8 below the same declaration stays.
TEST_F(TableDialects, ReadsFslsAtlases) {
  const auto labels = [](const std::string& c) {
    return "<data><!-- <label> --><label index=\"0\" x=\"1\">A &amp; B</label><!-- \" --><label index = "
           "'4'>" +
           c + "</label><label>D</label></data></atlas>";
  };
  for (const char* c : {"\xe9", "\xc3\xa9"})
    EXPECT_THAT(summaries(names("<?xml version='1.0' encoding='ISO-8859-1'?>\n<atlas>" + labels(c),
                                NamesFormat::kFsl)),
                ElementsAre("4 \xc3\xa9"));
  EXPECT_THAT(items("faulty-rows"), ElementsAre("names.txt entry 3: \"D\" has no index"));
  EXPECT_THAT(summaries(names("<atlas><type>Probabilistic</type>" + labels("C"), NamesFormat::kFsl)),
              ElementsAre("1 A & B", "5 C"));
  EXPECT_THAT(summaries(names("<?xml version='1.0'?><J><Structures><Structure id='7' grayvalue='3'>Area "
                              "(hOc1)</Structure></Structures></J>",
                              NamesFormat::kFsl)),
              ElementsAre("3 Area (hOc1)"));
}

TEST_F(TableDialects, ReadsTermsOfOtherVocabularies) {
  const auto list = names(
      "label,name,name_de,acronym,synonyms,code,SNOMED,FMA "
      "ID,Type_CodingScheme,Type_CodeValue,Type_CodeMeaning,"
      "TypeModifier_CodingScheme,TypeModifier_CodeValue\n"
      "1,left_kidney,Niere,LK,nephros; ren,4101,64033007,7205,SCT,64033007,Kidney,SCT,7771000\n",
      NamesFormat::kCsv);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_THAT(list[0].terms,
              ElementsAre(Term{"de", "Niere"}, Term{"abbreviation", "LK"}, Term{"synonym", "nephros"},
                          Term{"synonym", "ren"}, Term{"SNOMED", "64033007"}, Term{"FMA", "7205"},
                          Term{"modifier SNOMED", "7771000"}));
  EXPECT_EQ(list[0].code, 4101);
  EXPECT_THAT(items("ignored-columns"), IsEmpty());
}

TEST_F(TableDialects, ReadsNamesWithoutLabels) {
  const auto list = names(
      "Structure,SegmentedPropertyTypeCodeSequence.CodingSchemeDesignator,"
      "SegmentedPropertyTypeCodeSequence.CodeValue,DicomRGBColor\n"
      "aorta,SCT,15825003,\"216,108,54\"\nAorta,SCT,1,\n",
      NamesFormat::kCsv);
  EXPECT_THAT(summaries(list), ElementsAre("aorta #d86c36"));
  EXPECT_FALSE(list[0].label);
  EXPECT_THAT(list[0].terms, ElementsAre(Term{"SNOMED", "15825003"}));
  EXPECT_THAT(items("duplicate-labels"), ElementsAre("\"Aorta\" at names.txt line 3"));
}

TEST_F(TableDialects, CountsColoursThatCannotBeRead) {
  EXPECT_THAT(summaries(names("label,name,r,g,b\n1,A,255,foo,21\n2,B,1,2,3\n3,C,,,\n", NamesFormat::kCsv)),
              ElementsAre("1 A", "2 B #010203", "3 C"));
  EXPECT_THAT(items("bad-colors"), ElementsAre("names.txt line 2: \"255,foo,21\""));
}

TEST_F(TableDialects, RefusesWorkbooksAndTablesThatLackColumns) {
  EXPECT_THAT(error("PK\3\4" + std::string(20, '\0')),
              HasSubstr("is a workbook (Excel, LibreOffice) or an archive"));
  EXPECT_THAT(error("Name,Color_R,Color_G,Color_B\none,1,2,3\n"), HasSubstr("LabelValue is missing"));
  EXPECT_THAT(error("LabelValue,Name,Color_R,Color_G\n1,one,1,2\n"),
              HasSubstr("has 2 of the three colour columns red, green and blue; add the third"));
  EXPECT_THAT(error("colour,weight\nred,2\n", NamesFormat::kCsv),
              HasSubstr("no column has labels or names; call one \"label\" and one \"name\""));
}

TEST_F(TableDialects, ReadsTheHierarchy) {
  const auto table = value_or_throw(read("id,name,parent\n10,Brain,\n1,Left,10\n2,Leaf,Left\n"));
  EXPECT_EQ(table.names.size(), 3u);
  ASSERT_EQ(table.hierarchy.size(), 3u);
  EXPECT_THAT(table.hierarchy[0].node->parents, IsEmpty());
  EXPECT_THAT(table.hierarchy[1].node->parents, ElementsAre("id:10"));
  EXPECT_THAT(table.hierarchy[2].node->parents, ElementsAre("id:1"));
  EXPECT_EQ(table.hierarchy[2].node->label, 2);
}

std::vector<std::string> parents_of_last(const NamesTable& table) {
  return table.hierarchy.back().node->parents;
}

/// Groups are listed regions or names, never ids of regions that no row has.
TEST_F(TableDialects, MakesNoGroupsOfIds) {
  const std::string rows = "id,name,path\n997,Body,/997/\n8,Thorax,/997/8/\n";
  const auto unlisted = read(rows + "2,heart,/997/8/35/\n");
  ASSERT_EQ(unlisted->hierarchy.size(), 3u);
  EXPECT_THAT(parents_of_last(*unlisted), ElementsAre("id:35", "id:8"));  // build_graph() counts the first
  const auto two = read("id,name,parent\n10,A,\n11,B,\n2,heart,10;11\n");
  ASSERT_EQ(two->hierarchy.size(), 3u);
  EXPECT_THAT(parents_of_last(*two), ElementsAre("id:10", "id:11"));
}

TEST_F(TableDialects, ReadsPathsWithAnglesAndLevels) {
  for (const char* text :
       {"id,name,path\n1,liver,Body > Abdomen > liver\n", "id,name,path\n1,liver,Body -> Abdomen -> liver\n",
        "id,name,path\n1,liver,Body::Abdomen::liver\n", "id,name,parent\n1,liver,Body > Abdomen\n",
        "id,level1,level 2,name\n1,Body,Abdomen,liver\n"}) {
    const auto table = read(text);
    ASSERT_EQ(table->hierarchy.size(), 3u) << text;
    EXPECT_EQ(table->hierarchy[0].node->name, "Body");
    EXPECT_EQ(table->hierarchy[1].node->name, "Abdomen");
    EXPECT_EQ(table->hierarchy[2].node->name, "liver");
    EXPECT_THAT(parents_of_last(*table), ElementsAre(table->hierarchy[1].node->key));
  }
}

}  // namespace
}  // namespace splatlas
