// A file under a temporary name until it is complete.
#pragma once

#include <filesystem>
#include <functional>

#include "format/result.h"

namespace splatlas {

/// Calls write(temporary) with a new name beside `path` and with its ending (libraries choose formats by it);
/// when that succeeds, syncs the file and renames it to `path`. `path` is the old file or the complete new
/// one; on failure and on interrupts the temporary is removed. kFailed names `path` in every case.
[[nodiscard]] Result<void> write_by_way_of_temporary(
    const std::filesystem::path& path,
    const std::function<Result<void>(const std::filesystem::path&)>& write);

}  // namespace splatlas
