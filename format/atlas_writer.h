// Writer of atlas files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/result.h"

namespace splatlas {

/// Trade-offs of size and time.
struct WriteOptions {
  int level = 12;        ///< Zstandard level, 1 (fast) to 22 (small)
  bool compact = false;  ///< omit the run models of x and y; readers derive them in milliseconds
  unsigned threads = 0;  ///< for compression; 0: one per core. The output does not depend on it.
  /// Called at intervals with the fraction done, 0 to 1, on the calling thread. May be empty.
  std::function<void(double)> progress = {};
  /// Structures with so many voxels get means of grey values for first pictures: 0.5 to 3 % of the values.
  std::uint64_t means_from = std::uint64_t{1} << 20;
};

/// Encodes an atlas in memory. Refuses inconsistent content (sizes, class ids, counts, indices).
/// Deterministic: the same content and options give the same bytes on every machine and with any number of
/// threads. Frees the arrays of `content` as it goes: move it in to save their memory.
[[nodiscard]] Result<std::vector<std::byte>> encode_atlas(AtlasContent content,
                                                          const WriteOptions& options = {});

/// Encodes an atlas and replaces `path` atomically: writes a temporary file in its folder, syncs and renames
/// it. On failure `path` keeps its old content and the temporary file is removed.
[[nodiscard]] Result<void> write_atlas(AtlasContent content, const std::filesystem::path& path,
                                       const WriteOptions& options = {});

}  // namespace splatlas
