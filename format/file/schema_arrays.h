// Arrays and flags of FlatBuffers' structs, and strings: one buffer, and the end of each string in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <flatbuffers/flatbuffers.h>

namespace splatlas {

/// Flags of schema::Structure.
inline constexpr std::uint8_t kFlagLabel = 1, kFlagExternal = 2;

/// Converts n numbers.
template <std::size_t n, typename T, typename Source>
std::array<T, n> to_array(const Source& source) {
  std::array<T, n> values{};
  for (std::size_t i = 0; i < n; ++i)
    values[i] = static_cast<T>(source[static_cast<flatbuffers::uoffset_t>(i)]);
  return values;
}

/// The projection of a scene that is not parallel.
inline constexpr std::string_view kPerspective = "perspective";

/// Concatenates strings.
class TextWriter {
 public:
  void add(std::initializer_list<std::string_view> texts) {
    for (const std::string_view text : texts) {
      bytes_.insert(bytes_.end(), text.begin(), text.end());
      ends_.push_back(static_cast<std::uint32_t>(bytes_.size()));
    }
  }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  [[nodiscard]] const std::vector<std::uint32_t>& ends() const { return ends_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint32_t> ends_;
};

/// Reads strings in their order. The caller has checked their ends and number.
class TextReader {
 public:
  TextReader(const flatbuffers::Vector<std::uint32_t>& ends, const flatbuffers::Vector<std::uint8_t>& text)
      : ends_(ends), text_(text) {}
  std::string next() {
    const std::uint32_t end = ends_.Get(n_++);
    const auto* text = reinterpret_cast<const char*>(text_.data());
    return std::string(text + std::exchange(begin_, end), text + end);
  }

 private:
  const flatbuffers::Vector<std::uint32_t>& ends_;
  const flatbuffers::Vector<std::uint8_t>& text_;
  flatbuffers::uoffset_t n_ = 0;
  std::uint32_t begin_ = 0;
};

}  // namespace splatlas
