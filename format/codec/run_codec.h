// Encoding of run lists: the runs of one class along one principal axis.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "format/content/run_model.h"
#include "format/result.h"

namespace splatlas {

/// Maps 0, -1, 1, -2, ... to 0, 1, 2, 3, ...
template <std::signed_integral T>
[[nodiscard]] constexpr std::make_unsigned_t<T> zigzag(T value) {
  using Unsigned = std::make_unsigned_t<T>;
  return (static_cast<Unsigned>(value) << 1) ^ static_cast<Unsigned>(value >> std::numeric_limits<T>::digits);
}

template <std::unsigned_integral T>
[[nodiscard]] constexpr std::make_signed_t<T> unzigzag(T code) {
  using Signed = std::make_signed_t<T>;
  return static_cast<Signed>(code >> 1) ^ -static_cast<Signed>(code & 1);
}

/// Appends an encoded run list (valid, see validate_runs()) to `bytes`; nothing for an empty list. The code
/// is a sequence of varints, column by column: number of runs, scanline differences, lengths, starts. Lengths
/// and starts are differences from the run of the same rank in the previous scanline of the class.
void append_run_list(std::span<const Run> runs, std::vector<std::byte>& bytes);

/// Decodes a run list. kInvalidAtlas unless the bytes are exactly one list of at most `max_runs` runs. The
/// caller must validate the runs against the grid. Memory: 16 bytes per run of >= 3 bytes.
[[nodiscard]] Result<ClassRuns> decode_run_list(std::span<const std::byte> bytes, std::uint64_t max_runs);

/// Bounds of the encoded length of a list that covers `voxels` voxels.
[[nodiscard]] constexpr std::uint64_t min_run_list_bytes(std::uint64_t voxels) {
  return voxels == 0 ? 0 : 4;
}
[[nodiscard]] constexpr std::uint64_t max_run_list_bytes(std::uint64_t voxels) {
  return voxels == 0 ? 0 : 10 + 20 * voxels;  // varints of 64, 64, 33 and 33 bits
}

}  // namespace splatlas
