// Arrays and flags of FlatBuffers' structs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

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

/// For constructors of structs.
template <typename T, std::size_t n>
flatbuffers::span<const T, n> to_span(const std::array<T, n>& values) {
  return flatbuffers::span<const T, n>(values.data(), n);
}

}  // namespace splatlas
