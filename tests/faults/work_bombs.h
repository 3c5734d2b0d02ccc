// Atlas files of less than 2 MiB that ask for much work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace splatlas {

struct WorkBomb {
  std::string name;
  std::function<std::vector<std::byte>()> make;
};

/// Two voxels in giant grids, fitted surfaces in large boxes, deep graphs, long lists of runs, grey values
/// that decompress to gigabytes, and files that just keep within the budget.
[[nodiscard]] std::vector<WorkBomb> work_bombs();

/// A random grid of up to 2^40 voxels with up to 30 structures of some boxes each.
[[nodiscard]] std::vector<std::byte> sparse_giant(std::uint32_t seed);

}  // namespace splatlas
