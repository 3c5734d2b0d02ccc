#include "format/text/printable_text.h"

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(PrintableText, EscapesPiecesButNotTheLayout) {
  const std::string name = "a\nb\x1b[31m\xe2\x80\x8f";
  const std::string expected = "\ta?b?[31m?:a?b?[31m?:a?b?[31m? 7\n";
  EXPECT_EQ(PrintableText("\t{}:{}:{} {}\n", name, name.c_str(), std::filesystem::path(name), 7).text(),
            expected);
  PrintableText added;
  added.add("\t{}:", std::string_view(name)).add("{}:{} {}\n", name, name, 7u);
  EXPECT_EQ(added.text(), expected);
}

TEST(PrintableText, AlignsEscapedPieces) {
  EXPECT_EQ(PrintableText("[{:<4}|{:>5.1f}]", "a\n", 2.25).text(), "[a?  |  2.2]");
}

TEST(PrintableText, OfLayoutKeepsLineFeedsAndTabsOnly) {
  EXPECT_EQ(PrintableText::of_layout("a\n\tb\x1b\xff").text(), "a\n\tb?\\xff");
}

}  // namespace
}  // namespace splatlas
