#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "preprocess/import/tables/names_table.h"
#include "tests/preprocess/import/tables/names_cases.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

class ReadNames : public NamesTest {};

TEST_F(ReadNames, TellsTheDialect) {
  ASSERT_TRUE(read("1 A\n"));
  EXPECT_THAT(items("names-format"), ElementsAre("names.txt is read as list of labels and names"));
  EXPECT_FALSE(notes_.all().front().level() == NoteLevel::kWarning);
}

TEST_F(ReadNames, OverridesTheDetection) {
  const std::string rows = "1 a_b 255 0 0 255\n2 c 0 255 0 255\n";
  EXPECT_THAT(summaries(names(rows, NamesFormat::kCtbl)), ElementsAre("1 a b #ff0000", "2 c #00ff00"));
  const auto table = value_or_throw(read(rows, NamesFormat::kFreeSurfer));
  EXPECT_EQ(table.dialect, NamesFormat::kFreeSurfer);
  EXPECT_THAT(summaries(table.names), ElementsAre("1 a_b #ff0000", "2 c #00ff00"));
  EXPECT_THAT(error(rows, NamesFormat::kNiivue), HasSubstr("NiiVue colour map: byte 3 is no JSON"));
  EXPECT_THAT(error(rows, NamesFormat::kCsv), HasSubstr("line 1: holds no comma"));
}

TEST_F(ReadNames, KeepsTheFirstOfTwoRowsOfALabel) {
  EXPECT_THAT(summaries(names("5 A\n6 B\n5 C\n", NamesFormat::kMricron)), ElementsAre("5 A", "6 B"));
  EXPECT_THAT(items("duplicate-labels"), ElementsAre("label 5 at names.txt line 3"));
  EXPECT_TRUE(notes_.all().front().level() == NoteLevel::kWarning);
}

TEST_F(ReadNames, NumbersLabelsWithoutAName) {
  EXPECT_THAT(summaries(names("4 A\n5\n6 \"\"\n", NamesFormat::kMricron)),
              ElementsAre("4 A", "5 Label 5", "6 Label 6"));
  EXPECT_THAT(items("missing-names"), ElementsAre("5 (names.txt line 2)", "6 (names.txt line 3)"));
}

TEST_F(ReadNames, CountsFaultyRows) {
  EXPECT_THAT(summaries(names("1 A\nsecond B\n-3 C\n4294967296 D\n4294967295 E\n", NamesFormat::kMricron)),
              ElementsAre("1 A", "4294967295 E"));
  EXPECT_THAT(items("faulty-rows"),
              ElementsAre("names.txt line 2: \"second\" is no label (whole, 0 to 4294967295)",
                          HasSubstr("line 3: \"-3\""), HasSubstr("line 4: \"4294967296\"")));
  EXPECT_EQ(names("1 A\n2 a\tb\n3 " + std::string(201, 'x') + "\n", NamesFormat::kMricron).size(), 1u);
  EXPECT_THAT(items("faulty-rows"), ElementsAre(HasSubstr("a tab"), HasSubstr("201 characters")));
}

TEST_F(ReadNames, RefusesFilesWithoutAUsableRow) {
  EXPECT_THAT(error("# nothing\n"), HasSubstr("names.txt: names no label"));
  EXPECT_THAT(error(""), HasSubstr("names.txt: names no label"));
  EXPECT_THAT(error("0 Background\n"), HasSubstr("as list of labels and names: names no label; correct it"));
  EXPECT_THAT(error("-3 A\n-4 B\n"), AllOf(HasSubstr("names.txt: cannot be read as list of labels and names: "
                                                     "line 1: \"-3\" is no label"),
                                           HasSubstr("--names-format")));
  EXPECT_THAT(error("\"1\" A\n"), AllOf(HasSubstr("line 1: "), HasSubstr("auto, itksnap, niivue")));
  EXPECT_THAT(error(std::string("1 A\n2 B\0C\n", 10)),
              HasSubstr("names.txt: line 2 has a control character (byte 3: U+0000); plain UTF-8 text"));
  EXPECT_THAT(error("  # \xff\xfe\n1 A\n"),
              HasSubstr("names.txt: line 1 is not UTF-8 (byte 4); plain UTF-8 text"));
  EXPECT_THAT(error("1 A\n2 b\xe2\x80\xae c\n"), HasSubstr("bidirectional control character"));
}

/// A file of another dialect than --names-format says.
TEST_F(ReadNames, RefusesFilesOfTheWrongDialect) {
  const std::string table = "# id name\n4 Left-Ventricle 120 18 134 0\n";
  EXPECT_THAT(
      error(table, NamesFormat::kMricron),
      HasSubstr("names.txt: cannot be read as list of labels and names: line 2: \"4 Left-Ventricle 120 "
                "18 134 0\" has a colour; it is a row of a colour table; correct it, or give another "
                "--names-format"));
  EXPECT_EQ(read("1 A\n" + table, NamesFormat::kMricron)->names.size(), 1u);
  EXPECT_EQ(items("faulty-rows").size(), 1u);
  for (const NamesFormat format : {NamesFormat::kCtbl, NamesFormat::kFreeSurfer}) {
    for (const std::string line : {"1,Spleen,9,9,9,0", "1 9 9 9 1 1 1 \"Spleen\"", "Dear all"}) {
      EXPECT_THAT(error(line, format), AllOf(HasSubstr("line 1: \"" + line.substr(0, 3)),
                                             HasSubstr("is not: label name R G B A; correct it, or give")));
    }
  }
}

RC_GTEST_FIXTURE_PROP(ReadNames, AnySecondLineIsReadOrCounted, ()) {
  const auto line = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("\"12 \tax#-")));
  const auto table = read("7 first\n" + line + "\n");
  RC_ASSERT(table.has_value());
  for (const LabelName& name : table->names) RC_ASSERT(!name.name.empty());
  RC_ASSERT(table->names.size() + items("faulty-rows").size() + items("duplicate-labels").size() <= 2u);
}

}  // namespace
}  // namespace splatlas
