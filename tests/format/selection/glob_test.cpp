#include "format/selection/glob.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/text/ascii_text.h"
#include "tests/format/random_volume.h"
#include "tests/support/find_slowly.h"

namespace splatlas {
namespace {

TEST(Glob, ReadsPieceByPiece) {
  const Glob glob("brain/*/left");
  const auto start = glob.read(glob.start(), "Brain");
  EXPECT_TRUE(glob.accepts(glob.read(start, "/x/Left")));
  EXPECT_TRUE(glob.accepts(glob.read(glob.read(start, "/x"), "/left")));
  EXPECT_FALSE(glob.accepts(glob.read(start, "/left")));
  auto merged = glob.none();
  EXPECT_FALSE(glob.accepts(merged));
  Glob::merge(glob.read(start, "/nowhere"), merged);
  Glob::merge(glob.read(start, "?"), merged);
  EXPECT_TRUE(glob.accepts(glob.read(merged, "/left")));
}

RC_GTEST_PROP(Glob, MatchesLikeBruteForce, ()) {
  const auto pattern = *rc::gen::container<std::string>(*uniform<std::size_t>(0, 8),
                                                        rc::gen::element('a', 'B', '*', '*', '/'));
  const auto text =
      *rc::gen::container<std::string>(*uniform<std::size_t>(0, 10), rc::gen::element('a', 'A', 'b', '/'));
  RC_ASSERT(Glob(pattern).matches(text) == matches_slowly(to_lower(pattern), to_lower(text)));
}

TEST(Glob, ManyStarsTakeNoLonger) {
  // A backtracking matcher would try some 10^20 paths.
  std::string pattern;
  for (int n = 0; n < 30; ++n) pattern += "*a";
  EXPECT_FALSE(Glob(pattern + "*b").matches(std::string(200, 'a')));
}

}  // namespace
}  // namespace splatlas
