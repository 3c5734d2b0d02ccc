#include "bench/table.h"

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(Table, AlignsWordsToTheLeftAndNumbersToTheRight) {
  Table table;
  table.title = "A table";
  table.rows = {{{"name", "a"}, {"count", 12345}, {"ms", 0.12345}},
                {{"name", "longer"}, {"count", 7}, {"ms", 12.3456}}};
  table.notes = {"a note"};
  EXPECT_EQ(to_text(table),
            "A table\n"
            "  name    count     ms\n"
            "  a       12345  0.123\n"
            "  longer      7  12.35\n"
            "  a note\n");
}

TEST(Table, LeavesOutNothingThatOnlySomeRowsHave) {
  Table table;
  table.title = "Gaps";
  table.rows = {{{"a", 1}}, {{"a", nullptr}, {"b", 200.04}}, {{"b", 1234.5}}};
  EXPECT_EQ(to_text(table),
            "Gaps\n"
            "  a      b\n"
            "  1      -\n"
            "  -  200.0\n"
            "  -   1234\n");
}

}  // namespace
}  // namespace splatlas
