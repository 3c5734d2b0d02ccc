#include "preprocess/import/tables/read_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/preprocess/raw_image_files.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ReadNames : public testing::Test {
 protected:
  Result<std::vector<LabelName>> read(const std::string& text) const {
    write_bytes(folder_.file("names.txt"), text);
    return read_names(folder_.file("names.txt"));
  }
  std::string error(const std::string& text) const {
    const auto names = read(text);
    return names ? "no error" : names.error().message;
  }
  TemporaryFolder folder_;
};

TEST_F(ReadNames, ReadsAalsFile) {
  const auto names = read("1 Precentral_L 2001\r\n2 Precentral_R 2002\r\n\r\n");
  ASSERT_TRUE(names) << names.error().message;
  ASSERT_EQ(names->size(), 2u);
  EXPECT_EQ((*names)[1].label, 2);
  EXPECT_EQ((*names)[1].name, "Precentral_R");
  EXPECT_EQ((*names)[1].code, 2002);
  EXPECT_FALSE((*names)[1].color);
  EXPECT_EQ((*names)[1].line, 2u);
}

TEST_F(ReadNames, ReadsNamesOfSeveralWordsTabsAndQuotes) {
  const auto names = read(
      "\xef\xbb\xbf# a comment\n0\tUnclassified\n7\tMiddle cerebellar peduncle\n8 \"Lobule 5\"\n9 Lobule "
      "5\n10 Noyau caudé\r11 x");
  ASSERT_TRUE(names) << names.error().message;
  ASSERT_EQ(names->size(), 5u);
  EXPECT_EQ((*names)[0].name, "Middle cerebellar peduncle");
  EXPECT_EQ((*names)[0].line, 3u);
  EXPECT_EQ((*names)[1].name, "Lobule 5");
  EXPECT_FALSE((*names)[1].code);
  EXPECT_EQ((*names)[2].name, "Lobule");
  EXPECT_EQ((*names)[2].code, 5);
  EXPECT_EQ((*names)[3].name, "Noyau caudé");
  EXPECT_EQ((*names)[4].label, 11);
}

TEST_F(ReadNames, ReadsItkSnapsColumns) {
  const auto names = read(
      "    0     0    0    0        0  0  0    \"Clear Label\"\n   17   255  128    0        1  1  1    "
      "\"Left Hippocampus\"\n");
  ASSERT_TRUE(names) << names.error().message;
  ASSERT_EQ(names->size(), 1u);
  EXPECT_EQ((*names)[0].label, 17);
  EXPECT_EQ((*names)[0].name, "Left Hippocampus");
  EXPECT_EQ((*names)[0].color, (Rgb{255, 128, 0}));
}

TEST_F(ReadNames, TellsTheLineOfAFault) {
  EXPECT_THAT(error("1 A\nsecond B\n"), AllOf(HasSubstr("names.txt: line 2"), HasSubstr("'second'")));
  EXPECT_THAT(error("-3 A\n"), HasSubstr("'-3'"));
  EXPECT_THAT(error("4294967296 A\n"), HasSubstr("'4294967296'"));
  EXPECT_THAT(error("\n\n5\n"), AllOf(HasSubstr("line 3"), HasSubstr("label 5 has no name")));
  EXPECT_THAT(error("5 A\n6 B\n5 C\n"), AllOf(HasSubstr("line 3"), HasSubstr("in line 1")));
  EXPECT_THAT(error("# nothing\n"), HasSubstr("names no label"));
  EXPECT_THAT(error(std::string("1 A\n2 B\0C\n", 10)),
              HasSubstr("names.txt: line 2 has a control character (byte 3: U+0000); plain UTF-8 text"));
  EXPECT_THAT(error("  # \xff\xfe\n1 A\n"),
              HasSubstr("names.txt: line 1 is not UTF-8 (byte 4); plain UTF-8 text"));
  EXPECT_THAT(error("1 A\n2 b\xe2\x80\xae c\n"),
              AllOf(HasSubstr("names.txt: line 2"), HasSubstr("bidirectional control character")));
  EXPECT_THAT(error("1 A\n\"2\"foo\n"), AllOf(HasSubstr("names.txt: line 2"), HasSubstr("'\"2\"foo'")));
  EXPECT_THAT(error("\"1\" A\n"), AllOf(HasSubstr("line 1"), HasSubstr("no label")));
  EXPECT_THAT(error("1 \"\"\n"), HasSubstr("label 1 has no name"));
  EXPECT_THAT(error("1 A\n2 B\n3 a\n"), AllOf(HasSubstr("line 3"), HasSubstr("'a'"), HasSubstr("in line 1")));
  EXPECT_THAT(error("1 a\tb c\n"), AllOf(HasSubstr("line 1"), HasSubstr("a tab")));
  EXPECT_THAT(error("1 " + std::string(201, 'x') + "\n"), HasSubstr("201 characters"));
}

TEST_F(ReadNames, RefusesColoursBeyondAByteAndOpenQuotes) {
  const auto line = [](const std::string& colour) {
    return "3 A\n17 " + colour + " 255 1 1 \"Hippocampus\"\n";
  };
  for (const std::string colour : {"256 0 0", "0 -1 0", "0 0 1.5", "0 0 99999999999999999999"}) {
    EXPECT_THAT(error(line(colour)), AllOf(HasSubstr("names.txt: line 2: "), HasSubstr("from 0 to 255")));
  }
  EXPECT_THAT(error(line("300 0 0")), HasSubstr("the colour value 300 "));
  EXPECT_EQ(error(line("255 0 0")), "no error");
  EXPECT_EQ(read("4 one of the six other plain \"words\"\n")->front().name,
            "one of the six other plain \"words\"");
  for (const std::string open :
       {"17 255 128 0 1 1 1 \"Left", "17 \"Left hippocampus", "17 Left \"hippocampus 4"}) {
    EXPECT_THAT(error("3 A\n" + open + "\n"),
                AllOf(HasSubstr("names.txt: line 2: \""), HasSubstr("no closing quote; add it")));
  }
}

RC_GTEST_FIXTURE_PROP(ReadNames, AnyLineIsReadOrRefusedWithItsNumber, ()) {
  const auto line = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("\"12 \tax#-")));
  const auto names = read("7 first\n" + line + "\n");
  if (names) {
    for (const LabelName& name : *names) RC_ASSERT(!name.name.empty());
  } else {
    RC_ASSERT(names.error().message.find("names.txt: line 2: ") != std::string::npos);
  }
}

TEST_F(ReadNames, ReadsColorTables) {
  std::string table(768, '\0');
  table[7] = '\x10', table[256 + 7] = '\x20', table[512 + 7] = '\x30';
  write_bytes(folder_.file("a.lut"), table);
  const auto colors = read_color_table(folder_.file("a.lut"));
  ASSERT_TRUE(colors);
  EXPECT_EQ((*colors)[7], (Rgb{0x10, 0x20, 0x30}));
  for (const std::size_t size : {0u, 767u, 769u}) {
    write_bytes(folder_.file("a.lut"), std::string(size, 'x'));
    EXPECT_FALSE(read_color_table(folder_.file("a.lut")));
  }
}

}  // namespace
}  // namespace splatlas
