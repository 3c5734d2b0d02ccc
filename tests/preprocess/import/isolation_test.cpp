#include <array>
#include <csignal>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/isolation/run_isolated.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

struct Number {
  std::int64_t value = 0;
  friend void transfer(auto& archive, Number& number) { archive(number.value); }
};

/// The result of `read` in a child.
template <typename Read>
Result<Number> isolated(const Read& read) {
  return run_isolated<Number>("file", [&]() -> Result<Number> { return read(); });
}

TEST(RunIsolated, HandsBackValuesAndErrors) {
  EXPECT_EQ(isolated([] { return Number{-5}; })->value, -5);
  EXPECT_THAT(isolated([]() -> Result<Number> { return fail(ErrorCode::kUsage, "a message"); }),
              FailsWith(ErrorCode::kUsage, "a message"));
}

TEST(RunIsolated, HandsBackEveryMemberOfAnImage) {
  SourceImage image;
  image.grid = {.size = {3, 2, 1},
                .spacing_mm = {1, 2, 3},
                .origin_lps_mm = {4, 5, 6},
                .direction_lps = {0, 1, 0, 1, 0, 0, 0, 0, 1}};
  image.voxels = {VoxelType::kInt16, std::vector<std::byte>(std::size_t{3} << 20, std::byte{7})};
  image.layers = 9;
  image.is_segmentation = true;
  SourceSegment segment{2, -3, {}};
  segment.structure.name = "kidney";
  segment.structure.label = 5;
  segment.structure.code = 6;
  segment.structure.color = Rgb{1, 2, 3};
  segment.structure.external = true;
  segment.structure.terms = {{"SCT", "1"}, {"de", "Niere"}};
  image.segments = {segment, {}};
  image.notes.add("kind", "item");
  const Result<SourceImage> back =
      run_isolated<SourceImage>("file", [&]() -> Result<SourceImage> { return image; });
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->grid, image.grid);
  EXPECT_EQ(back->voxels, image.voxels);
  EXPECT_EQ(back->layers, 9u);
  EXPECT_TRUE(back->is_segmentation);
  ASSERT_EQ(back->segments.size(), 2u);
  const SourceSegment& first = back->segments[0];
  EXPECT_EQ(first.layer, 2u);
  EXPECT_EQ(first.value, -3);
  EXPECT_EQ(first.structure.name, "kidney");
  EXPECT_EQ(first.structure.label, 5);
  EXPECT_EQ(first.structure.code, 6);
  EXPECT_EQ(first.structure.color, (Rgb{1, 2, 3}));
  EXPECT_TRUE(first.structure.external);
  EXPECT_EQ(first.structure.terms, segment.structure.terms);
  EXPECT_FALSE(back->segments[1].structure.label);
  ASSERT_EQ(back->notes.all().size(), 1u);
  EXPECT_EQ(back->notes.all()[0].kind, "kind");
  EXPECT_EQ(back->notes.all()[0].items, std::vector<std::string>{"item"});
}

/// A library may end a child in any way; this process goes on, with one line.
TEST(RunIsolated, SurvivesEveryEndOfAChild) {
  const auto message = [](auto end) {
    const Result<Number> result = isolated([&] {
      report_child_progress("slice.dcm");
      end();
      return Number{};
    });
    EXPECT_FALSE(result);
    return result ? std::string() : result.error().message;
  };
  EXPECT_THAT(message([] { ::raise(SIGSEGV); }), HasSubstr("slice.dcm: its reader crashed (signal 11)"));
  EXPECT_THAT(message([] { std::abort(); }), HasSubstr("crashed (signal 6)"));
  EXPECT_THAT(message([] { throw 5; }), HasSubstr("gave up"));
  EXPECT_THAT(message([] { std::exit(0); }), HasSubstr("gave up"));  // NOLINT(concurrency-mt-unsafe)
  EXPECT_THAT(message([] { ::_exit(42); }), HasSubstr("no whole answer"));
  EXPECT_THAT(message([] { throw std::bad_alloc(); }), HasSubstr("needs more than 512 MiB"));
}

TEST(RunIsolated, BoundsMemory) {
#ifdef SPLATLAS_SANITIZED
  GTEST_SKIP() << "sanitizers map terabytes";
#endif
  const auto grow = [] {
    std::vector<std::vector<char>> pieces;
    while (true) pieces.emplace_back(std::size_t{64} << 20, 'x');
    return Number{};
  };
  EXPECT_THAT(isolated(grow), FailsWith(ErrorCode::kLimit, HasSubstr("needs more than 512 MiB")));
}

TEST(RunIsolated, BoundsTimeWithoutProgress) {
  const ChildLimits limits{.cpu_seconds = 0.2, .wall_seconds = 0.6};
  const ChildLimits cpu_limit{.cpu_seconds = 0.2, .wall_seconds = 60};  // on a busy machine, too
  const auto spin = [](std::FILE*) {
    volatile bool never = false;  // compilers may leave out other endless loops
    while (!never) {
    }
    return true;
  };
  EXPECT_THAT(run_child("slow.nii", cpu_limit, spin).error().message,
              HasSubstr("slow.nii: reading it took more than 0 seconds"));
  const auto sleep = [](std::FILE*) {
    ::sleep(20);
    return true;
  };
  EXPECT_THAT(run_child("asleep.nii", limits, sleep).error().message, HasSubstr("took more than 1 seconds"));
  // With progress it may take longer.
  const auto advance = [](std::FILE*) {
    for (int n = 0; n < 10; ++n) {
      ::usleep(100'000);
      report_child_progress("slice");
    }
    return true;
  };
  EXPECT_TRUE(run_child("long.nii", limits, advance));
}

TEST(RunIsolated, EndsTheChildrenOfAChild) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  EXPECT_TRUE(isolated([] {
    if (::fork() == 0) ::sleep(20);
    return Number{};
  }));
  ::close(ends[1]);
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0) << "a process still holds the other end";
  ::close(ends[0]);
}

TEST(RunIsolated, WaitsForChildrenThatTheCallerIgnores) {
  const auto before = ::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(isolated([] { return Number{3}; })->value, 3);
  EXPECT_EQ(::signal(SIGCHLD, before), SIG_IGN) << "as before";
}

/// What libraries print may name patients.
TEST(RunIsolated, DropsWhatAChildPrints) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  EXPECT_TRUE(isolated([] {
    ::write(STDERR_FILENO, "Doe^John", 8);
    ::write(STDOUT_FILENO, "Doe^John", 8);
    return Number{};
  }));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace splatlas
