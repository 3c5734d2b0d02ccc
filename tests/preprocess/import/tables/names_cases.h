// Names files written by tests, and what their readers say.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "preprocess/import/tables/names_table.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {

/// Reads names from text in a temporary folder.
class NamesTest : public testing::Test {
 protected:
  Result<NamesTable> read(const std::string& text, NamesFormat format = NamesFormat::kAuto) {
    write_bytes(folder_.file("names.txt"), text);
    notes_ = {};
    return read_names(folder_.file("names.txt"), format, notes_);
  }
  /// The names of a file that must be read as a dialect.
  std::vector<LabelName> names(const std::string& text, NamesFormat dialect) {
    const auto table = read(text);
    if (!table) {
      ADD_FAILURE() << table.error().message;
      return {};
    }
    EXPECT_EQ(table->dialect, dialect);
    return table->names;
  }
  std::string error(const std::string& text, NamesFormat format = NamesFormat::kAuto) {
    const auto table = read(text, format);
    return table ? "no error" : table.error().message;
  }
  /// Items of a kind of notes.
  [[nodiscard]] std::vector<std::string> items(const std::string& kind) const {
    return items_of(notes_, kind);
  }

  TemporaryFolder folder_;
  Notes notes_;
};

/// Folder of real files; empty if SPLATLAS_TEST_DATA does not name one.
inline std::string test_data() {
  const char* data = std::getenv("SPLATLAS_TEST_DATA");
  return data == nullptr ? "" : data;
}

inline const LabelName* find_label(const std::vector<LabelName>& names, std::int64_t label) {
  const auto found = std::ranges::find(names, label, [](const LabelName& n) { return n.label.value_or(-1); });
  return found == names.end() ? nullptr : &*found;
}

/// "17 Left Hippocampus #dcd814"; the colour only if there is one.
inline std::string summary(const LabelName& name) {
  std::string text = name.label ? std::to_string(*name.label) + " " : "";
  text += name.name;
  return name.color ? text + " " + to_hex(*name.color) : text;
}
inline std::vector<std::string> summaries(const std::vector<LabelName>& names) {
  std::vector<std::string> texts;
  for (const LabelName& name : names) texts.push_back(summary(name));
  return texts;
}

}  // namespace splatlas
