#include "tests/campaigns/faults/mutate.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include <zlib.h>

#include "tests/preprocess/raw_image_files.h"

namespace splatlas {
namespace {

/// A number below `end`, which is positive.
std::size_t below(std::size_t end, std::mt19937& random) {
  return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
}

/// A place in the file; in its first KiB most of the time.
std::size_t place(const std::string& bytes, std::mt19937& random) {
  constexpr std::size_t kHeader = 1024;
  return below(random() % 4 != 0 ? std::min(bytes.size(), kHeader) : bytes.size(), random);
}

std::string flip_bits(std::string bytes, std::mt19937& random) {
  for (std::size_t n = 1 + below(8, random); n > 0; --n)
    bytes[place(bytes, random)] ^= static_cast<char>(1u << random() % 8);
  return bytes;
}

/// Numbers in texts: the digits at a random place become another number.
std::optional<std::string> replace_digits(const std::string& bytes, std::mt19937& random) {
  constexpr std::array kNumbers{"4294967295", "2147483648", "-1", "1e308", "99999999999999999999",
                                "nan",        "0",          "-0", "65536", "1e-320"};
  constexpr const char* kDigits = "0123456789";
  const std::size_t first = bytes.find_first_of(kDigits, place(bytes, random));
  if (first == std::string::npos) return std::nullopt;
  const std::size_t last = std::min(bytes.find_first_not_of(kDigits, first), bytes.size());
  return bytes.substr(0, first) + kNumbers.at(below(kNumbers.size(), random)) + bytes.substr(last);
}

/// Numbers in binary headers: one, two, four or eight bytes of the ends of a range.
std::string replace_word(std::string bytes, std::mt19937& random) {
  constexpr std::array<std::uint64_t, 7> kWords{
      ~std::uint64_t{0},  0x7fffffffffffffff, 0x8000000000000000, 0x7fffffff7fffffff, 0,
      0x7fc000007f800000,  // an infinity and a NaN
      0x00ffffff00ffffff};
  const std::size_t size = std::size_t{1} << random() % 4, at = place(bytes, random) / size * size;
  std::memcpy(&bytes[at], &kWords.at(below(kWords.size(), random)), std::min(size, bytes.size() - at));
  return bytes;
}

std::string insert(std::string bytes, std::mt19937& random) {
  std::string some(1 + below(64, random), '\0');
  for (char& byte : some) byte = static_cast<char>(random());
  return bytes.insert(place(bytes, random), some);
}

/// A block, from its place in the file.
std::pair<std::size_t, std::size_t> block(const std::string& bytes, std::mt19937& random) {
  const std::size_t first = place(bytes, random);
  return {first, 1 + below(std::min<std::size_t>(bytes.size() - first, 4096), random)};
}

std::string repeat(std::string bytes, std::mt19937& random) {
  const auto [first, length] = block(bytes, random);
  std::string copies;
  for (std::size_t n = 1 + below(16, random); n > 0; --n) copies += bytes.substr(first, length);
  return bytes.insert(first, copies);
}

std::string swap_blocks(std::string bytes, std::mt19937& random) {
  std::size_t a = place(bytes, random), b = place(bytes, random);
  if (a > b) std::swap(a, b);
  const std::size_t length = std::min({b - a, bytes.size() - b, std::size_t{4096}});
  const auto at = [&](std::size_t n) { return bytes.begin() + static_cast<std::ptrdiff_t>(n); };
  std::swap_ranges(at(a), at(a + length), at(b));
  return bytes;
}

/// The content of a gzip file, up to 16 MiB.
std::optional<std::string> inflated(const std::string& bytes) {
  constexpr std::size_t kMost = std::size_t{16} << 20;
  z_stream stream{};
  if (!bytes.starts_with("\x1f\x8b") || inflateInit2(&stream, 15 + 16) != Z_OK) return std::nullopt;
  std::string input = bytes, content(kMost, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(content.data());
  stream.avail_out = static_cast<uInt>(content.size());
  const bool is_whole = inflate(&stream, Z_FINISH) == Z_STREAM_END && stream.total_out > 0;
  content.resize(stream.total_out);
  inflateEnd(&stream);
  return is_whole ? std::optional(std::move(content)) : std::nullopt;
}

}  // namespace

Mutant mutate(const std::string& bytes, std::mt19937& random) {
  if (bytes.empty()) return {"\n", "inserted bytes"};
  switch (below(9, random)) {
    case 0: return {flip_bits(bytes, random), "flipped bits"};
    case 1:
      if (std::optional<std::string> replaced = replace_digits(bytes, random))
        return {*std::move(replaced), "huge numbers"};
      [[fallthrough]];
    case 2: return {replace_word(bytes, random), "huge numbers"};
    case 3: return {bytes.substr(0, below(bytes.size(), random)), "cut"};
    case 4: return {bytes.substr(0, bytes.size() * (4 + random() % 3) / 10), "cut at 40 to 60 %"};
    case 5: return {insert(bytes, random), "inserted bytes"};
    case 6: return {repeat(bytes, random), "repeated bytes"};
    case 7: return {swap_blocks(bytes, random), "swapped blocks"};
    default: {
      const auto [first, length] = block(bytes, random);
      return {std::string(bytes).erase(first, length), "erased bytes"};
    }
  }
}

Mutant mutate_inflated(const std::string& bytes, std::mt19937& random) {
  const std::optional<std::string> content = inflated(bytes);
  if (!content) return mutate(bytes, random);
  Mutant mutant = mutate(*content, random);
  mutant.bytes = deflated(mutant.bytes, true);
  return mutant;
}

}  // namespace splatlas
