#include "preprocess/import/tables/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/raw_image_files.h"
#include "tests/support/fails_with.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

TEST(StructureName, TakesWhatPeopleWrite) {
  for (const std::string name : {"a", "Noyau caudé", "Left (upper) lobe, 2nd part", "脳", "7"}) {
    EXPECT_TRUE(check_structure_name(name)) << name;
  }
}

TEST(StructureName, CountsCharactersNotBytes) {
  std::string umlauts;
  for (std::size_t n = 0; n < kMaxNameCharacters; ++n) umlauts += "ü";
  EXPECT_TRUE(check_structure_name(umlauts));
  EXPECT_THAT(check_structure_name(umlauts + "x").error().message, HasSubstr("201 characters"));
}

TEST(StructureName, RefusesWhatNobodyCanType) {
  const std::string blank = "; write a blank instead", control = "has a control character";
  for (const auto& [name, what] :
       {std::pair<std::string, std::string>{"a\nb", "\"a?b\" holds a line feed as character 2" + blank},
        {"\u00fc?\tb", "holds a tab as character 3" + blank},
        {"a\x7f", control + " (byte 1: U+007F)"},
        {"\x1b[31m", control + " (byte 0: U+001B)"}}) {
    const auto refused = check_structure_name(name);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr(what));
    EXPECT_EQ(refused.error().message.find_first_of("\n\t\x1b\x7f"), std::string::npos);
  }
  EXPECT_THAT(check_structure_name("").error().message, HasSubstr("empty"));
  EXPECT_THAT(check_structure_name("  ").error().message, HasSubstr("empty"));
  EXPECT_THAT(check_structure_name("caud\xe9").error().message, HasSubstr("UTF-8"));
  EXPECT_THAT(check_structure_name("a\xe2\x80\xae").error().message,
              HasSubstr("bidirectional control character"));
}

TEST(StructureName, KeysAreEqualForNamesThatLookupsConfuse) {
  EXPECT_EQ(name_key(" Screw "), name_key("sCREW"));
  EXPECT_NE(name_key("Screw 1"), name_key("Screw 2"));
}

TEST(FileHash, IsSha256OfTheBytes) {
  const TemporaryFolder folder;
  write_bytes(folder.file("a"), "");
  EXPECT_EQ(hash_file(folder.file("a")).value(),
            "sha256:e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");  // FIPS 180-2
  write_bytes(folder.file("a"), "abc");
  EXPECT_EQ(hash_file(folder.file("a")).value(),
            "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  // Links to nothing are no files of a folder, and do not end its list
  for (int n = 0; n < 20; ++n) std::filesystem::create_symlink("none", folder.file(fmt::format("link{}", n)));
  EXPECT_EQ(hash_file(folder.path()).value(), hash_file(folder.file("a")).value());
}

}  // namespace
}  // namespace splatlas
