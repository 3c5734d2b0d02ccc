// Which pages of a file the system has in memory.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Bytes of the file's pages that are in the page cache now; the last page counts to the file's end.
[[nodiscard]] Result<std::uint64_t> resident_bytes(const std::filesystem::path& path);

/// Drops a file's pages from the page cache, unwritten ones after they are written. kFailed when some stay:
/// the file is mapped, or lies in a file system without a disk below it.
[[nodiscard]] Result<void> evict(const std::filesystem::path& path);

}  // namespace splatlas
