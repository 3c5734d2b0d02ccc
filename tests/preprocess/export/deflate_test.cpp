#include "preprocess/export/deflate.h"

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <zlib.h>

#include "format/result_macros.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

using testing::Each;
using testing::Le;

std::span<const std::byte> bytes_in(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string inflated(std::string packed, std::size_t bytes) {
  std::string result(bytes + 1, '\0');
  z_stream stream{};
  inflateInit2(&stream, 15 + 32);
  stream.next_in = reinterpret_cast<unsigned char*>(packed.data());
  stream.avail_in = static_cast<unsigned>(packed.size());
  stream.next_out = reinterpret_cast<unsigned char*>(result.data());
  stream.avail_out = static_cast<unsigned>(result.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  EXPECT_EQ(stream.avail_in, 0u);
  result.resize(stream.total_out);
  inflateEnd(&stream);
  return result;
}

std::string random_bytes(std::size_t size) {
  std::mt19937 random(7);
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

TEST(DeflateInPieces, JoinsPartsToOneStreamOfSmallPieces) {
  const std::string noise = random_bytes(3'000'001), text(1'000'000, 'x');
  for (const DeflateWrapper wrapper : {DeflateWrapper::kZlib, DeflateWrapper::kGzip}) {
    std::string packed;
    std::vector<std::size_t> sizes;
    ASSERT_TRUE(deflate_in_pieces({bytes_in(noise), {}, bytes_in(text)}, wrapper, {6}, "f",
                                  [&](std::span<const std::byte> piece) -> Result<void> {
                                    packed.append(reinterpret_cast<const char*>(piece.data()), piece.size());
                                    sizes.push_back(piece.size());
                                    return {};
                                  }));
    EXPECT_EQ(inflated(packed, noise.size() + text.size()), noise + text);
    EXPECT_EQ(packed.starts_with("\x1f\x8b"), wrapper == DeflateWrapper::kGzip);
    EXPECT_GT(sizes.size(), 10u);
    EXPECT_THAT(sizes, Each(Le(std::size_t{1} << 18)));
  }
}

TEST(DeflateInPieces, NoBytesAreAStreamToo) {
  std::string packed;
  ASSERT_TRUE(deflate_in_pieces({}, DeflateWrapper::kZlib, {2}, "f",
                                [&](std::span<const std::byte> piece) -> Result<void> {
                                  packed.append(reinterpret_cast<const char*>(piece.data()), piece.size());
                                  return {};
                                }));
  EXPECT_EQ(inflated(packed, 0), "");
}

TEST(DeflateInPieces, StopsAtTheFirstError) {
  int calls = 0;
  const std::string noise = random_bytes(3'000'001);
  const Result<void> result =
      deflate_in_pieces({bytes_in(noise)}, DeflateWrapper::kGzip, {2}, "f", [&](auto) -> Result<void> {
        if (++calls == 2) return fail(ErrorCode::kFailed, "full");
        return {};
      });
  EXPECT_THAT(result, FailsWith(ErrorCode::kFailed, "full"));
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace splatlas
