// Mutations that keep checksums and sizes right, to reach the code behind them.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "tests/fuzz/mutate_number.h"

namespace splatlas {

using Bytes = std::vector<std::byte>;
/// Mutates bytes as libFuzzer does, to at most `max_bytes` of them.
using MutateBytes = std::function<void(Bytes& bytes, std::size_t max_bytes)>;

/// A mutated atlas: other directory entries, stream or chunk bytes or header fields, or another atlas. Input
/// that is no atlas becomes one. The result may exceed `max_bytes`.
[[nodiscard]] Bytes mutate_atlas(Bytes file, std::size_t max_bytes, Random& random,
                                 const MutateBytes& mutate_bytes);

}  // namespace splatlas
