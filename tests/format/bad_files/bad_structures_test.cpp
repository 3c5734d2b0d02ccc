// Invalid files: structures, their hierarchy, and strings.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

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

constexpr BadFile kIds[] = {
    {"no id", [](RawAtlas& a) { a.set_text(kIdOfCore, ""); }, "F: invalid: structure 1 (\"Core\") has no id"},
    {"no id and a strange name",
     [](RawAtlas& a) {
       a.set_text(kIdOfCore, "");
       a.set_text(kNameOfCore, "a\x1b[2J");
     },
     "F: invalid: structure 1 (\"a?[2J\") has no id"},
    {"a blank in an id", [](RawAtlas& a) { a.set_text(kIdOfCore, "co re"); },
     "F: invalid: the id \"co re\" of a structure holds other characters than letters, digits, \"_\", \"-\" "
     "and \".\""},
    {"a slash in an id", [](RawAtlas& a) { a.set_text(kIdOfCore, "../core"); },
     "F: invalid: the id \"../core\" of a structure holds other characters than letters, digits, \"_\", "
     "\"-\" and \".\""},
    {"an id beyond ASCII", [](RawAtlas& a) { a.set_text(kIdOfCore, "Größe"); },
     "F: invalid: the id \"Gr\xC3\xB6\xC3\x9F"
     "e\" of a structure holds other characters than letters, digits, \"_\", \"-\" and \".\""},
    {"a zero in an id", [](RawAtlas& a) { a.set_text(kIdOfCore, std::string("co\0re", 5)); },
     "F: invalid: the id \"co?re\" of a structure holds other characters than letters, digits, \"_\", \"-\" "
     "and \".\""},
    {"an id of a megabyte with a bad end",
     [](RawAtlas& a) { a.set_text(kIdOfCore, std::string(1 << 20, 'x') + "*"); },
     "F: invalid: the id "
     "\"xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...\" of a structure "
     "holds other characters than letters, digits, \"_\", \"-\" and \".\""},
    {"an id twice", [](RawAtlas& a) { a.set_text(kIdOfRim, "core"); },
     "F: invalid: two structures have the id \"core\" (case does not count)"},
    {"an id twice but for its case", [](RawAtlas& a) { a.set_text(kIdOfRim, "CORE"); },
     "F: invalid: two structures have the id \"CORE\" (case does not count)"},
    {"a name twice, which may be", [](RawAtlas& a) { a.set_text(kNameOfRim, "Core"); }, ""},
    {"no name, which may be", [](RawAtlas& a) { a.set_text(kNameOfRim, ""); }, ""},
};

constexpr BadFile kParents[] = {
    {"its own parent", [](RawAtlas& a) { a.directory.parents[0] = good::kCore; },
     "F: invalid: structures form a cycle: core in core"},
    {"two in a circle", [](RawAtlas& a) { a.directory.parents[0] = good::kRim; },
     "F: invalid: structures form a cycle: core in rim in core"},
    {"three in a circle",
     [](RawAtlas& a) {
       a.directory.parents = {good::kRim, good::kKnob, good::kKnob, good::kCore};
       a.directory.parents[2] = good::kAll;
     },
     "F: invalid: structures form a cycle: core in rim in knob in core"},
    {"a parent twice", [](RawAtlas& a) { a.directory.parents[2] = good::kAll; },
     "F: invalid: structure \"rim\" has the parent \"all\" twice"},
    {"a parent that is not there", [](RawAtlas& a) { a.directory.parents[3] = 5; },
     "F: invalid: structure \"knob\" has parent number 5 of 5 structures"},
    {"the largest parent", [](RawAtlas& a) { a.directory.parents[3] = 0xffffffff; },
     "F: invalid: structure \"knob\" has parent number 4294967295 of 5 structures"},
    {"one parent too many", [](RawAtlas& a) { a.directory.parents.push_back(0); },
     "F: invalid: inconsistent offsets of directory table of parents"},
    {"one parent too few", [](RawAtlas& a) { a.directory.parents.pop_back(); },
     "F: invalid: inconsistent offsets of directory table of parents"},
    {"ends of parents that fall", [](RawAtlas& a) { a.directory.structures[2].parents_end = 0; },
     "F: invalid: inconsistent offsets of directory table of parents"},
    {"an end of parents beyond them", [](RawAtlas& a) { a.directory.structures[4].parents_end = 5; },
     "F: invalid: inconsistent offsets of directory table of parents"},
    {"the largest end of parents", [](RawAtlas& a) { a.directory.structures[1].parents_end = 0xffffffff; },
     "F: invalid: inconsistent offsets of directory table of parents"},
    {"one structure too few", [](RawAtlas& a) { a.directory.structures.pop_back(); },
     "F: invalid: directory has 19 strings, expected 17"},
    {"one structure too many",
     [](RawAtlas& a) { a.directory.structures.push_back(a.directory.structures.back()); },
     "F: invalid: directory has 19 strings, expected 21"},
    {"no structures", [](RawAtlas& a) { a.directory.structures.clear(); },
     "F: invalid: directory has 19 strings, expected 9"},
    {"a chain 257 deep",
     [](RawAtlas& a) {
       RawDirectory& d = a.directory;
       std::vector<std::uint32_t> ends;
       for (std::uint32_t s = 0; s < 257; ++s) {
         d.structures.push_back({0, static_cast<std::uint32_t>(d.parents.size()), {}, 0});
         if (s > 0)
           d.parents.push_back(5 + s - 1),
               d.structures.back().parents_end = static_cast<std::uint32_t>(d.parents.size());
       }
       const std::vector<std::uint8_t> text(d.text.begin(), d.text.end());
       for (std::uint32_t s = 0; s < 257;
            ++s) {  // an id and no name for each, ahead of the text of the scene
         const std::string id = fmt::format("d{}", s);
         const std::size_t at = 14 + 2 * std::size_t{s};
         const std::uint32_t begin = d.text_ends[at - 1];
         d.text_ends.insert(d.text_ends.begin() + static_cast<std::ptrdiff_t>(at), 2, begin);
         a.set_text(at, id);
       }
     },
     "F: invalid: structure \"d256\" lies deeper than 256 levels"},
    {"more structures than the limit",
     [](RawAtlas& a) {
       const RawStructure last = a.directory.structures.back();
       a.directory.structures.resize((1 << 20) + 1, last);
       a.directory.text_ends.resize(a.directory.text_ends.size() + 2 * ((1 << 20) - 4),
                                    a.directory.text_ends.back());
     },
     "F: invalid: 1048577 structures (limit 1048576) and 8 classes (1 to 16777216)"},
    {"unknown flags, which are not read", [](RawAtlas& a) { a.directory.structures[0].flags |= 0xfc; }, ""},
    {"a label where none is said to be, which is not read",
     [](RawAtlas& a) { a.directory.structures[0].label = 1; }, ""},
};

constexpr BadFile kTexts[] = {
    {"title not UTF-8", [](RawAtlas& a) { a.set_text(kTitle, "G\xff"); },
     "F: invalid: provenance is not UTF-8 (byte 1)"},
    {"citation not UTF-8", [](RawAtlas& a) { a.set_text(kCitation, "\xc3("); },
     "F: invalid: provenance is not UTF-8 (byte 0)"},
    {"licence not UTF-8", [](RawAtlas& a) { a.set_text(kLicence, "\xed\xa0\x80"); },
     "F: invalid: provenance is not UTF-8 (byte 0)"},
    {"tool not UTF-8", [](RawAtlas& a) { a.set_text(kTool, "\xc0\xaf"); },
     "F: invalid: provenance is not UTF-8 (byte 0)"},
    {"a name not UTF-8", [](RawAtlas& a) { a.set_text(kNameOfCore, "K\xf6rper"); },
     "F: invalid: name of structure 1 is not UTF-8 (byte 1)"},
    {"a scene's name not UTF-8", [](RawAtlas& a) { a.set_text(kSceneName, "\x80"); },
     "F: invalid: text of scene 0 is not UTF-8 (byte 0)"},
    {"a caption not UTF-8", [](RawAtlas& a) { a.set_text(kCaption, "cut off \xe2\x82"); },
     "F: invalid: text of scene 0 is not UTF-8 (byte 8)"},
    {"a selection not UTF-8", [](RawAtlas& a) { a.set_text(kSelection, "\xf4\x90\x80\x80"); },
     "F: invalid: text of scene 0 is not UTF-8 (byte 0)"},
    {"a role not UTF-8", [](RawAtlas& a) { a.set_text(kRole, "\xfe"); },
     "F: invalid: a source's role is not UTF-8 (byte 0)"},
    {"a hash not UTF-8", [](RawAtlas& a) { a.set_text(kHash, "\xf0\x9f\xa7"); },
     "F: invalid: a source's hash is not UTF-8 (byte 0)"},
    {"a zero in the title", [](RawAtlas& a) { a.set_text(kTitle, std::string("a\0b", 3)); },
     "F: invalid: provenance has a control character (byte 1: U+0000)"},
    {"a bell in the citation", [](RawAtlas& a) { a.set_text(kCitation, "ring\a"); },
     "F: invalid: provenance has a control character (byte 4: U+0007)"},
    {"a carriage return in the licence", [](RawAtlas& a) { a.set_text(kLicence, "MIT\r"); },
     "F: invalid: provenance has a control character (byte 3: U+000D)"},
    {"an escape in the tool", [](RawAtlas& a) { a.set_text(kTool, "\x1b]0;owned\a"); },
     "F: invalid: provenance has a control character (byte 0: U+001B)"},
    {"a delete in a name", [](RawAtlas& a) { a.set_text(kNameOfCore, "Core\x7f"); },
     "F: invalid: name of structure 1 has a control character (byte 4: U+007F)"},
    {"a backspace in a scene's name", [](RawAtlas& a) { a.set_text(kSceneName, "First\b"); },
     "F: invalid: text of scene 0 has a control character (byte 5: U+0008)"},
    {"a form feed in a caption", [](RawAtlas& a) { a.set_text(kCaption, "a\fb"); },
     "F: invalid: text of scene 0 has a control character (byte 1: U+000C)"},
    {"an escape in a selection", [](RawAtlas& a) { a.set_text(kSelection, "\x1b[2J"); },
     "F: invalid: text of scene 0 has a control character (byte 0: U+001B)"},
    {"a control character in a role", [](RawAtlas& a) { a.set_text(kRole, "\x01"); },
     "F: invalid: a source's role has a control character (byte 0: U+0001)"},
    {"a control character in a hash", [](RawAtlas& a) { a.set_text(kHash, "\x1f"); },
     "F: invalid: a source's hash has a control character (byte 0: U+001F)"},
    {"a control sequence of eight bits in a name",
     [](RawAtlas& a) {
       a.set_text(kNameOfCore,
                  "a\xc2\x9b"
                  "2J");
     },
     "F: invalid: name of structure 1 has a control character (byte 1: U+009B)"},
    {"text that runs backwards in a name",
     [](RawAtlas& a) {
       a.set_text(kNameOfCore,
                  "a\xe2\x80\xae"
                  "b");
     },
     "F: invalid: name of structure 1 has a bidirectional control character (byte 1: U+202E)"},
    {"an isolate in a caption",
     [](RawAtlas& a) {
       a.set_text(kCaption,
                  "a\xe2\x81\xa6"
                  "b");
     },
     "F: invalid: text of scene 0 has a bidirectional control character (byte 1: U+2066)"},
    {"line feeds and tabs, which may be", [](RawAtlas& a) { a.set_text(kCaption, "one\n\ttwo"); }, ""},
    {"Hebrew with its marks, which may be",
     [](RawAtlas& a) { a.set_text(kNameOfCore, "\xd7\x9e\xd7\x95\xd7\x97\xe2\x80\x8f"); }, ""},
};

constexpr BadFile kTextTables[] = {
    {"one string too few", [](RawAtlas& a) { a.directory.text_ends.pop_back(); },
     "F: invalid: directory has 18 strings, expected 19"},
    {"one string too many",
     [](RawAtlas& a) { a.directory.text_ends.push_back(a.directory.text_ends.back()); },
     "F: invalid: directory has 20 strings, expected 19"},
    {"no strings", [](RawAtlas& a) { a.directory.text_ends.clear(); },
     "F: invalid: directory has 0 strings, expected 19"},
    {"ends of strings that fall",
     [](RawAtlas& a) { a.directory.text_ends[3] = a.directory.text_ends[2] - 1; },
     "F: invalid: inconsistent offsets of directory text"},
    {"a string that ends beyond the text", [](RawAtlas& a) { ++a.directory.text_ends.back(); },
     "F: invalid: inconsistent offsets of directory text"},
    {"text that no string has", [](RawAtlas& a) { a.directory.text.push_back('x'); },
     "F: invalid: inconsistent offsets of directory text"},
    {"the largest end of a string", [](RawAtlas& a) { a.directory.text_ends[0] = 0xffffffff; },
     "F: invalid: inconsistent offsets of directory text"},
    {"no text", [](RawAtlas& a) { a.directory.text.clear(); },
     "F: invalid: inconsistent offsets of directory text"},
    {"one source too many", [](RawAtlas& a) { ++a.directory.sources; },
     "F: invalid: directory has 19 strings, expected 21"},
    {"one source too few", [](RawAtlas& a) { --a.directory.sources; },
     "F: invalid: directory has 19 strings, expected 17"},
    {"2^32 - 1 sources", [](RawAtlas& a) { a.directory.sources = 0xffffffff; },
     "F: invalid: directory has 19 strings, expected 8589934607"},
    {"one scene too many",
     [](RawAtlas& a) {
       a.directory.scenes.push_back({0, 0, 1});
     },
     "F: invalid: directory has 19 strings, expected 22"},
    {"no scenes", [](RawAtlas& a) { a.directory.scenes.clear(); },
     "F: invalid: directory has 19 strings, expected 16"},
};

TEST(BadFiles, WithABadId) {
  expect_refused(kIds);
}
TEST(BadFiles, WithABadParent) {
  expect_refused(kParents);
}
TEST(BadFiles, WithBadText) {
  expect_refused(kTexts);
}
TEST(BadFiles, WithABadTextTable) {
  expect_refused(kTextTables);
}

}  // namespace
}  // namespace splatlas
