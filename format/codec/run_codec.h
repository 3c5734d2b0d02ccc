// The run lists of the file, as bytes: one class along one principal axis.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/result.h"
#include "format/run_model.h"

namespace splatlas {

/// Appends the code of a run list (valid, see validate_runs()) to `bytes`; nothing for an empty list.
/// Variable-length integers in columns: number of runs, scanline steps, lengths, starts. Lengths and starts
/// are differences to the run of the same rank in the class's previous scanline, which is where the other
/// edge of the shape is.
void append_run_list(std::span<const Run> runs, std::vector<std::byte>& bytes);

/// The list again. kInvalidAtlas when the bytes are not exactly a code of at most `max_runs` runs. The runs
/// still have to be checked against the grid. Memory: 16 bytes a run, three bytes of code at least each.
[[nodiscard]] Result<ClassRuns> decode_run_list(std::span<const std::byte> bytes, std::uint64_t max_runs);

/// Bounds of the length of a list that covers `voxels` voxels.
[[nodiscard]] constexpr std::uint64_t min_run_list_bytes(std::uint64_t voxels) {
  return voxels == 0 ? 0 : 4;
}
[[nodiscard]] constexpr std::uint64_t max_run_list_bytes(std::uint64_t voxels) {
  return voxels == 0 ? 0 : 10 + 20 * voxels;  // varints of 64, 64, 33 and 33 bits
}

}  // namespace splatlas
