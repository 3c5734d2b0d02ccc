// Invalid files: structures, their hierarchy, and strings.
#include <string_view>

#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

using namespace std::string_view_literals;

/// Strings by their number in the file.
enum Text : std::size_t {
  kTitle,
  kCitation,
  kLicence,
  kTool,
  kIdOfAll,
  kNameOfAll,
  kIdOfCore,
  kNameOfCore,
  kIdOfRim,
  kNameOfRim,
  kSceneName = 14,
  kCaption,
  kSelection,
  kRole,
  kHash
};

/// Another text of a string.
struct BadText {
  Text string;
  std::string_view text;
  const char* message = "";
};

constexpr auto set_text = [](RawAtlas& a, const BadText& row) {
  a.set_text(row.string, std::string(row.text));
};

constexpr BadText kCharacters[] = {
    {kIdOfCore, "../core", "../core"},
    {kIdOfCore, "co\0re"sv, "co?re"},
};

constexpr BadText kRepeatedIds[] = {
    {kIdOfRim, "core", "core"},
    {kIdOfRim, "CORE", "CORE"},
};

constexpr BadText kTexts[] = {
    {kTitle, "G\xff", "provenance is not UTF-8 (byte 1)"},
    {kCitation, "\xc3(", "provenance is not UTF-8 (byte 0)"},
    {kLicence, "\xed\xa0\x80", "provenance is not UTF-8 (byte 0)"},
    {kTool, "\xc0\xaf", "provenance is not UTF-8 (byte 0)"},
    {kTool, "\xe0\x9f\xbf", "provenance is not UTF-8 (byte 0)"},
    {kTool, "\xf0\x8f\xbf\xbf", "provenance is not UTF-8 (byte 0)"},
    {kNameOfCore, "K\xf6rper", "name of structure 1 is not UTF-8 (byte 1)"},
    {kSceneName, "\x80", "text of scene 0 is not UTF-8 (byte 0)"},
    {kCaption, "cut off \xe2\x82", "text of scene 0 is not UTF-8 (byte 8)"},
    {kSelection, "\xf4\x90\x80\x80", "text of scene 0 is not UTF-8 (byte 0)"},
    {kRole, "\xfe", "a source's role is not UTF-8 (byte 0)"},
    {kHash, "\xf0\x9f\xa7", "a source's hash is not UTF-8 (byte 0)"},
    {kTitle, "a\0b"sv, "provenance has a control character (byte 1: U+0000)"},
    {kTool, "\x1b]0;owned\a", "provenance has a control character (byte 0: U+001B)"},
    {kNameOfCore, "Core\x7f", "name of structure 1 has a control character (byte 4: U+007F)"},
    {kNameOfCore, "a\u009b2J", "name of structure 1 has a control character (byte 1: U+009B)"},
    {kNameOfCore, "a\u202eb", "name of structure 1 has a bidirectional control character (byte 1: U+202E)"},
    {kCaption, "a\u2066b", "text of scene 0 has a bidirectional control character (byte 1: U+2066)"},
};

constexpr BadText kValidTexts[] = {
    {kCaption, "one\n\ttwo"},
    {kTitle, "\xed\x9f\xbf\xee\x80\x80\xf4\x8f\xbf\xbf"},
    {kNameOfCore, "\u05de\u05d5\u05d7\u200f"},  // Hebrew with its marks
    {kNameOfRim, "Core"},                       // a name twice
    {kNameOfRim, ""},
};

using BadDirectory = BadFile<RawDirectory>;

constexpr BadPart<RawDirectory> kParents[] = {
    {[](auto& d) { d.parents[0] = good::kCore; }, "structures form a cycle: core in core"},
    {[](auto& d) { d.parents[2] = good::kAll; }, "structure \"rim\" has the parent \"all\" twice"},
    {[](auto& d) { d.parents[3] = 5; }, "structure \"knob\" has parent number 5 of 5 structures"},
    {[](auto& d) {
       const RawStructure last = d.structures.back();
       d.structures.resize((1 << 20) + 1, last);
       d.text_ends.resize(d.text_ends.size() + 2 * ((1 << 20) - 4), d.text_ends.back());
     },
     "1048577 structures (limit 1048576) and 8 classes (1 to 16777216)"},
};

constexpr BadDirectory kEndsOfParents[] = {
    {"one parent too many", [](auto& d) { d.parents.push_back(0); }},
    {"that fall", [](auto& d) { d.structures[2].parents_end = 0; }},
    {"beyond the parents", [](auto& d) { d.structures[4].parents_end = 5; }},
};

constexpr BadDirectory kValidStructures[] = {
    {"unknown flags", [](auto& d) { d.structures[0].flags |= 0xfc; }},
    {"a label where none is said to be", [](auto& d) { d.structures[0].label = 1; }},
};

constexpr BadPart<RawDirectory> kStringCounts[] = {
    {[](auto& d) { d.structures.pop_back(); }, "19 strings, expected 17"},
    {[](auto& d) { d.text_ends.pop_back(); }, "18 strings, expected 19"},
    {[](auto& d) { ++d.sources; }, "19 strings, expected 21"},
    {[](auto& d) { d.sources = 0xffffffff; }, "19 strings, expected 8589934607"},
    {[](auto& d) {
       d.scenes.push_back(RawScene{0, 0, 1});
     },
     "19 strings, expected 22"},
};

constexpr BadDirectory kEndsOfText[] = {
    {"that fall", [](auto& d) { d.text_ends[3] = d.text_ends[2] - 1; }},
    {"beyond the text", [](auto& d) { ++d.text_ends.back(); }},
    {"ahead of text", [](auto& d) { d.text.push_back('x'); }},
};

TEST(BadFiles, WithABadId) {
  const char* const message =
      "F: invalid: the id \"{}\" of a structure holds other characters than letters, digits, \"_\", \"-\" "
      "and "
      "\".\"";
  expect_faults(kCharacters, message, set_text);
  RawAtlas atlas = raw_atlas(good_file());
  atlas.set_text(kIdOfCore, std::string(1 << 20, 'x') + "*");
  expect_fault(atlas, message, (std::string(80, 'x') + "...").c_str(), "a megabyte with a bad end");
  expect_faults(kRepeatedIds, "F: invalid: two structures have the id \"{}\" (case does not count)",
                set_text);

  atlas.set_text(kIdOfCore, "");
  expect_fault(atlas, "F: invalid: structure 1 (\"Core\") has no id", "", "no id");
  atlas.set_text(kNameOfCore, "a\x1b[2J");
  expect_fault(atlas, "F: invalid: structure 1 (\"a?[2J\") has no id", "", "no id and a strange name");
}

TEST(BadFiles, WithABadParent) {
  expect_faults(kParents, "F: invalid: {}", in_directory);
  expect_faults(kEndsOfParents, "F: invalid: inconsistent offsets of directory table of parents",
                in_directory);
  expect_faults(kValidStructures, "", in_directory);
}

TEST(BadFiles, WithBadText) {
  expect_faults(kTexts, "F: invalid: {}", set_text);
  expect_faults(kValidTexts, "", set_text);
  expect_faults(kStringCounts, "F: invalid: directory has {}", in_directory);
  expect_faults(kEndsOfText, "F: invalid: inconsistent offsets of directory text", in_directory);
}

}  // namespace
}  // namespace splatlas
