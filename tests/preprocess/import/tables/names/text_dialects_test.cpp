// Dialects of lines: ITK-SNAP, 3D Slicer, FreeSurfer, MRIcron.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/text/ascii_text.h"
#include "tests/preprocess/import/tables/names_cases.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

class TextDialects : public NamesTest {};

TEST_F(TextDialects, ReadsItkSnap) {
  EXPECT_THAT(summaries(names("################\r\n# ITK-SnAP Label Description File\r\n"
                              "    0     0    0    0        0  0  0    \"Clear Label\"\r\n"
                              "   17   255  128    0        0.5  1  1    \"Left, \t lower lobe\"\r\n"
                              "614454277\t1\t2\t3\t1\t1\t1\t\"x\" rest",
                              NamesFormat::kItkSnap)),
              ElementsAre("614454277 x #010203"));  // a tab in a name is a fault
  EXPECT_THAT(items("faulty-rows"), ElementsAre(HasSubstr("a tab")));
  EXPECT_THAT(summaries(names("17 255 128 0 1 1 1 \"Left, lower lobe\"\n", NamesFormat::kItkSnap)),
              ElementsAre("17 Left, lower lobe #ff8000"));
}

TEST_F(TextDialects, CountsFaultsOfItkSnap) {
  const std::string good = "1 1 1 1 1 1 1 \"A\"\n2 2 2 2 1 1 1 \"B\"\n3 3 3 3 1 1 1 \"C\"\n";
  EXPECT_EQ(names(good + "4 256 0 0 1 1 1 \"D\"\n", NamesFormat::kItkSnap).size(), 4u);
  EXPECT_THAT(items("bad-colors"), ElementsAre("names.txt line 4: \"256 0 0\""));
  EXPECT_EQ(names(good + "4 255 0 0 1 1 1 \"Open\n5 E\n", NamesFormat::kItkSnap).size(), 3u);
  EXPECT_THAT(items("faulty-rows"), ElementsAre(HasSubstr("no closing quote"), HasSubstr("\"5 E\" is not")));
}

TEST_F(TextDialects, ReadsSlicersTables) {
  EXPECT_THAT(summaries(names("# Color table file a.ctbl\n# 3 values\n0 zero 0 0 0 255\n1 Fallopian_tube 255 "
                              "59 21 255\n2 5 41 84 255 255\n3 _ 1 1 1 255\n",
                              NamesFormat::kCtbl)),
              ElementsAre("1 Fallopian tube #ff3b15", "2 5 #2954ff", "3 Label 3 #010101"));
  EXPECT_THAT(items("missing-names"), ElementsAre("3 (names.txt line 6)"));
  EXPECT_THAT(summaries(names("5       Vagina  255   230   225   255\r\n", NamesFormat::kCtbl)),
              ElementsAre("5 Vagina #ffe6e1"));
  EXPECT_THAT(error("# Color procedural file x\n0 0 0 0\n"), HasSubstr("is a colour ramp"));
}

TEST_F(TextDialects, ReadsFreeSurfersTables) {
  EXPECT_THAT(summaries(names("\n#No. Label Name:                            R   G   B   A\n\n"
                              "0   Unknown                                 0   0   0   0\n"
                              "17  Left-Hippocampus                        220 216 20  0\n"
                              "902 Artery                                  255 0   0   255\n"
                              "1001 ctx_lh_x 25 100 40 0 1",
                              NamesFormat::kFreeSurfer)),
              ElementsAre("17 Left-Hippocampus #dcd814", "902 Artery #ff0000", "1001 ctx_lh_x #196428"));
  EXPECT_THAT(
      summaries(names("# Cerebellar parcellation labels\nID\tLabelName           \tR\tG\tB\tA\n"
                      "0\tUnknown             \t0\t0\t0\t0\n1\tLeft_I_IV           \t70\t130\t180\t0\n",
                      NamesFormat::kFreeSurfer)),
      ElementsAre("1 Left_I_IV #4682b4"));
}

TEST_F(TextDialects, NeverTakesColoursForNames) {
  for (const char* alpha : {" 0\n", " 255\n", "\n"}) {
    const auto table = value_or_throw(read(std::string("17 Left-Hippocampus 220 216 20") + alpha));
    EXPECT_THAT(summaries(table.names), ElementsAre(HasSubstr("ippocampus #dcd814")));
  }
  EXPECT_THAT(
      summaries(names("1 A 9 9 9 0\n2 B 8 8 8 0\n3 C 300 0 0 0\n4 D 7 x 7 0\n", NamesFormat::kFreeSurfer)),
      ElementsAre("1 A #090909", "2 B #080808", "3 C", "4 D"));
  EXPECT_THAT(items("bad-colors"), ElementsAre(HasSubstr("300 0 0"), HasSubstr("4 D 7 x 7 0")));
}

/// All rows decide where the colours stand, and whether they are fractions.
TEST_F(TextDialects, ReadsColoursWhereAllRowsHaveThem) {
  EXPECT_THAT(summaries(names("1 0.8 0.2 0.1 liver\r\n2 1 0 0 left heart\n3 0.9 0.9 0.7 Area 4\n",
                              NamesFormat::kFslEyes)),
              ElementsAre("1 liver #cc331a", "2 left heart #ff0000", "3 Area 4 #e6e6b3"));
  EXPECT_THAT(summaries(names("1 204 51 26 1 1 1 liver\n2 255 0 0 1 1 1 Area 4\n", NamesFormat::kItkSnap)),
              ElementsAre("1 liver #cc331a", "2 Area 4 #ff0000"));
  EXPECT_THAT(summaries(names("1 liver 203.9 51.2 25.8 255\n2 heart 255 0 0 127.5\n3 A 1 2 3 255\n",
                              NamesFormat::kCtbl)),
              ElementsAre("1 liver #cc331a", "2 heart #ff0000", "3 A #010203"));
  EXPECT_THAT(summaries(names("1\tLeft lung\t1\t0.5\t0\n2\tAorta\t0\t0\t1\n", NamesFormat::kCtbl)),
              ElementsAre("1 Left lung #ff8000", "2 Aorta #0000ff"));
  EXPECT_THAT(
      summaries(names("1 liver #cc331a\n2 left lung #0000ff\n3 Vertebra #101\n4 heart rgb(255, 0, 0)\n",
                      NamesFormat::kMricron)),
      ElementsAre("1 liver #cc331a", "2 left lung #0000ff", "3 Vertebra #101", "4 heart #ff0000"));
  EXPECT_THAT(summaries(names("liver\n1 204 51 26 255\nArea 4\n2 255 0 0 255\n", NamesFormat::kFslEyes)),
              ElementsAre("1 liver #cc331a", "2 Area 4 #ff0000"));  // of Connectome Workbench
  // The last numbers are the colour, unless the fourth can be an opacity
  EXPECT_THAT(summaries(names("1 Area 4 204 51 26\n2 Area 6 0 0 255\n", NamesFormat::kCtbl)),
              ElementsAre("1 Area 4 #cc331a", "2 Area 6 #0000ff"));
  EXPECT_THAT(summaries(names("1 Area 44 204 51 26 0\n2 Area 45 255 0 0 0\n3 spine 230 230 180 0\n",
                              NamesFormat::kFreeSurfer)),
              ElementsAre("1 Area 44 #cc331a", "2 Area 45 #ff0000", "3 spine #e6e6b4"));
  EXPECT_THAT(summaries(names("1 204 51 26 7 liver\n2 255 0 0 8 heart\n", NamesFormat::kFslEyes)),
              ElementsAre("1 7 liver #cc331a", "2 8 heart #ff0000"));
  EXPECT_THAT(summaries(names("1 0.8 0.2 0.1 1\n2 1 0 0 2\n", NamesFormat::kFslEyes)),
              ElementsAre("1 1 #cc331a", "2 2 #ff0000"));
  EXPECT_THAT(summaries(names("1\tBrodmann area 1 2 3\n2\tBA 4\n", NamesFormat::kMricron)),
              ElementsAre("1 Brodmann area 1 2 3", "2 BA 4"));
  EXPECT_THAT(summaries(names("1: liver\n2 = heart # seen\n3 BA 1 2\n", NamesFormat::kMricron)),
              ElementsAre("1 liver", "2 heart", "3 BA 1 2"));
}

/// A list, its first and last structure, and perhaps a doubt, a line each.
constexpr std::string_view kNumbers =
#include "tests/preprocess/import/tables/names/numbers_in_names.txt"
    ;

/// A whole number ahead of fractions: of the name or red, as all rows allow.
TEST_F(TextDialects, ReadsNamesThatEndInANumberBeforeFractions) {
  for (const std::string_view line : split(kNumbers, '\n')) {
    const std::vector<std::string_view> parts = split(line, '|');
    std::string text(parts[0]);
    std::ranges::replace(text, ';', '\n');
    const auto list = names(text, NamesFormat::kCtbl);
    EXPECT_EQ(summary(list.front()), parts[1]);
    EXPECT_EQ(summary(list.back()), parts[2]);
    const std::size_t reds = line.ends_with("red") ? 1 : 0;
    EXPECT_EQ(items("names-or-red").size(), parts.size() - 3 - reds) << line;
    EXPECT_EQ(items("red-or-names").size(), reds) << line;
  }
  names("1 T 1 0.8 0.2 0.1\n", NamesFormat::kCtbl);
  EXPECT_THAT(messages_of(notes_)[0],
              HasSubstr("header label,name,r,g,b or label,name,r,g,b,a decide: names.txt "
                        "line 1: \"1 T 1 0.8 0.2 0.1\""));
}

TEST_F(TextDialects, ReadsAalsFile) {
  const auto list = names("1 Precentral_L 2001\r\n2 Precentral_R 2002\r\n\r\n", NamesFormat::kMricron);
  EXPECT_THAT(summaries(list), ElementsAre("1 Precentral_L", "2 Precentral_R"));
  EXPECT_EQ(list[1].code, 2002);
  EXPECT_EQ(list[1].line, 2u);
  EXPECT_THAT(summaries(names("1 BA 10\n2 BA 11\n3 insula 2\n", NamesFormat::kMricron)),
              ElementsAre("1 BA 10", "2 BA 11", "3 insula 2"));  // codes would leave equal names
}

TEST_F(TextDialects, ReadsNamesOfSeveralWordsTabsAndQuotes) {
  const auto list = names(
      "\xef\xbb\xbf# a comment\n0\tUnclassified\n7\tMiddle cerebellar peduncle\n8 \"Lobule 5\"\n9 Lobule "
      "5\n10 Noyau caudé\r11 x",
      NamesFormat::kMricron);
  EXPECT_THAT(summaries(list), ElementsAre("7 Middle cerebellar peduncle", "8 Lobule 5", "9 Lobule",
                                           "10 Noyau caudé", "11 x"));
  EXPECT_EQ(list[0].line, 3u);
  EXPECT_FALSE(list[1].code);
  EXPECT_EQ(list[2].code, 5);
  EXPECT_THAT(summaries(names("7 lobe, label\n8 x\n", NamesFormat::kMricron)),
              ElementsAre("7 lobe, label", "8 x"));
}

TEST_F(TextDialects, CountsOpenQuotesOfLists) {
  for (const std::string open : {"17 \"Left hippocampus", "17 Left \"hippocampus 4"}) {
    EXPECT_EQ(names("3 A\n" + open + "\n", NamesFormat::kMricron).size(), 1u);
    EXPECT_THAT(items("faulty-rows"), ElementsAre(HasSubstr("no closing quote; add it")));
  }
  EXPECT_THAT(summaries(names("4 one of the six other plain \"words\"\n", NamesFormat::kMricron)),
              ElementsAre("4 one of the six other plain \"words\""));
}

}  // namespace
}  // namespace splatlas
