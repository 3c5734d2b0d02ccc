#include <algorithm>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "format/text/ascii_text.h"
#include "preprocess/export/export_labels.h"
#include "preprocess/import/tables/text_file.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

using Names = std::vector<std::string>;

Names file_names(const Names& names) {
  return file_names_of(names, ".nii.gz");
}

std::string file_name(const std::string& name) {
  return file_names({name}).front();
}

TEST(FileNames, KeepSafeNames) {
  for (const std::string name : {"Putamen_L", "a", "7", "_", "a-b", "a.b", "a..b", "_CON", "CONtrol", "com",
                                 "com10", "COMA", "nulls", "Label_1", "x-", "a_2"}) {
    EXPECT_EQ(file_name(name), name + ".nii.gz");
  }
  const std::string longest(kMaxNameCharacters, 'x');
  EXPECT_EQ(file_name(longest), longest + ".nii.gz");
}

TEST(FileNames, ReplaceUnsafeNames) {
  const std::vector<std::pair<std::string, std::string>> cases{{"", "_"},
                                                               {".", "__"},
                                                               {"..", "_._"},
                                                               {"-rf", "_-rf"},
                                                               {".hidden", "_.hidden"},
                                                               {"a/b", "a_b"},
                                                               {"a\\b", "a_b"},
                                                               {"../../etc/passwd", "_.._.._etc_passwd"},
                                                               {"a\nb\x1b[31m", "a_b_31m"},
                                                               {std::string("a\0b", 3), "a_b"},
                                                               {"a\xe2\x80\xae"
                                                                "b",
                                                                "a_b"},
                                                               {"trailing.", "trailing_"},
                                                               {"trailing ", "trailing_"},
                                                               {"trailing . .", "trailing_.__"},
                                                               {"C:a", "C_a"},
                                                               {"a*?<>|\"b", "a_b"},
                                                               {"$HOME;`x`", "_HOME_x_"},
                                                               {"CON ", "CON_"},
                                                               {"Br\xc3\xbc"
                                                                "cke",
                                                                "Br_cke"},  // u umlaut, one character
                                                               {"Bru\xcc\x88"
                                                                "cke",
                                                                "Bru_cke"}};
  for (const auto& [name, expected] : cases)
    EXPECT_EQ(file_name(name), expected + ".nii.gz") << printable(name);
  EXPECT_EQ(file_name(std::string(300, 'x')), std::string(200, 'x') + ".nii.gz");
  EXPECT_EQ(file_name(std::string(199, 'x') + "..x"), std::string(199, 'x') + "_.nii.gz");
}

TEST(FileNames, DifferByMoreThanCase) {
  EXPECT_THAT(file_names({"Liver", "LIVER", "liver", "liver_2"}),
              ElementsAre("Liver.nii.gz", "LIVER_3.nii.gz", "liver_4.nii.gz", "liver_2.nii.gz"));
}

TEST(FileNames, DifferAfterReplacement) {
  EXPECT_THAT(file_names({"a/b", "a_b", "a b", "a\\b"}),
              ElementsAre("a_b_2.nii.gz", "a_b.nii.gz", "a_b_3.nii.gz", "a_b_4.nii.gz"));
  // One word in both normal forms of Unicode
  EXPECT_THAT(file_names({"\xc3\xa9t\xc3\xa9", "e\xcc\x81te\xcc\x81"}),
              ElementsAre("_t_.nii.gz", "e_te_.nii.gz"));
  EXPECT_THAT(file_names({"\xc3\x85", "A\xcc\x8a", "\xe2\x84\xab"}),
              ElementsAre("_.nii.gz", "A_.nii.gz", "__2.nii.gz"));
  const std::string x(300, 'x');
  EXPECT_THAT(file_names({x + "a", x + "b"}),
              ElementsAre(std::string(200, 'x') + ".nii.gz", std::string(198, 'x') + "_2.nii.gz"));
}

/// Random names from few characters, so that many are unsafe and many collide.
TEST(FileNames, AreAlwaysSafeUniqueAndStable) {
  std::mt19937 random(1);
  const Names pieces{"a", "A", ".", "-", "/", " ", "_", "2", "\xc3\xa9", "con", "\n", std::string(120, 'y')};
  for (int round = 0; round < 300; ++round) {
    Names names;
    for (int n = 0; n < 40; ++n) {
      std::string name;
      for (auto length = random() % 5; length > 0; --length) name += pieces[random() % pieces.size()];
      names.push_back(name);
    }
    const Names files = file_names(names);
    ASSERT_EQ(files.size(), names.size());
    EXPECT_EQ(files, file_names(names));
    std::set<std::string> distinct;
    for (const std::string& file : files) {
      EXPECT_TRUE(distinct.insert(to_lower(file)).second) << file;
      EXPECT_TRUE(file.ends_with(".nii.gz"));
      EXPECT_LE(file.size(), kMaxNameCharacters + 7);
      EXPECT_TRUE(file.front() != '-' && file.front() != '.') << file;
      EXPECT_TRUE(std::ranges::all_of(file, [](char c) {
        return std::string_view("aAycontre-_.nigz0123456789").find(c) != std::string_view::npos;
      })) << file;
      // A file name is safe as a name.
      const std::string name = file.substr(0, file.size() - 7);
      EXPECT_EQ(file_name(name), file);
    }
  }
}

TEST(FileNames, OfManyEqualNamesTakeLinearTime) {
  const Names files = file_names(Names(20000, "a/b"));
  EXPECT_EQ(files.back(), "a_b_20000.nii.gz");
}

}  // namespace
}  // namespace splatlas
