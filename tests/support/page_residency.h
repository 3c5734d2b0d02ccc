// Residency of file pages in the page cache.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Bytes of the pages of the file in the page cache; the last page counts to the end of the file.
[[nodiscard]] Result<std::uint64_t> resident_bytes(const std::filesystem::path& path);

/// Drops the pages of a file from the page cache, dirty ones written. kFailed if some stay, as if mapped.
[[nodiscard]] Result<void> evict(const std::filesystem::path& path);

}  // namespace splatlas
