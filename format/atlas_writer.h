// Writes an atlas file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "format/atlas_content.h"
#include "format/result.h"

namespace splatlas {

struct WriteOptions {
  int level = 12;        ///< Zstandard level, 1 (fast) to 22 (small)
  bool compact = false;  ///< leave out what a reader derives in milliseconds: the run models of x and y
  unsigned threads = 0;  ///< for compression; 0: one per core. The bytes do not depend on it.
  /// Called now and then with the fraction done, 0..1, from the calling thread. May be empty.
  std::function<void(double)> progress = {};
};

/// The file's bytes, in memory. Refuses content that is not consistent (sizes, class numbers, counts,
/// indices). Same content and options: same bytes, on every machine and with any number of threads.
[[nodiscard]] Result<std::vector<std::byte>> encode_atlas(const AtlasContent& content,
                                                          const WriteOptions& options = {});

/// Writes to a temporary file beside `path`, syncs it, and renames it: `path` is the old file or the complete
/// new one, never anything else, and no temporary is left behind on failure.
[[nodiscard]] Result<void> write_atlas(const AtlasContent& content, const std::filesystem::path& path,
                                       const WriteOptions& options = {});

}  // namespace splatlas
