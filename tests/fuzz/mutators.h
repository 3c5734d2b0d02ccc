// Mutations that keep checksums and sizes right, to reach the code behind them.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "format/file/directory.h"
#include "tests/fuzz/mutate_number.h"

namespace splatlas {

using Bytes = std::vector<std::byte>;
/// Mutates bytes as libFuzzer does, to at most `max_bytes` of them.
using MutateBytes = std::function<void(Bytes& bytes, std::size_t max_bytes)>;

/// Changes one to three entries of any table, to valid or invalid values.
void mutate_directory(Directory& directory, Random& random);

/// A sparse atlas with another size of one axis, and with boxes stretched accordingly. Each class of
/// `directory` becomes voxels at the corners of its box, or a plate.
[[nodiscard]] Bytes stretched_atlas(const Directory& directory, Random& random);

/// A mutated atlas: other directory entries, stream or chunk bytes or header fields, or another atlas. Input
/// that is no atlas becomes one. The result may exceed `max_bytes`.
[[nodiscard]] Bytes mutate_atlas(Bytes file, std::size_t max_bytes, Random& random,
                                 const MutateBytes& mutate_bytes);

}  // namespace splatlas
