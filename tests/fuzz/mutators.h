// Mutations that keep checksums and sizes right: what checksums guard is reached, too.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "tests/fuzz/mutate_number.h"

namespace splatlas {

using Bytes = std::vector<std::byte>;
/// Changes bytes as libFuzzer does, to at most `most` of them.
using MutateBytes = std::function<void(Bytes& bytes, std::size_t most)>;

/// A file made of an atlas: other entries in its directory, other bytes in its streams or chunks, other
/// numbers in its header, or another atlas altogether. Of what is no atlas, it makes one. May come out longer
/// than `most`.
[[nodiscard]] Bytes mutate_atlas(Bytes file, std::size_t most, Random& random,
                                 const MutateBytes& mutate_bytes);

}  // namespace splatlas
