// The staged content of an output file, and its owner and permissions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include <sys/stat.h>

#include "format/io/checksum.h"
#include "format/io/staged_file.h"
#include "format/result.h"

namespace splatlas {

/// A file that has no name yet, and the target that it will replace.
struct UnfinishedFile {
  /// Creates the staged file in `folder`, on the file system of the target. kFailed also for a closed handle,
  /// with the reason from errno.
  [[nodiscard]] Result<void> create(FolderHandle folder);
  /// Verifies the bytes of write(), sets owner and permissions, and syncs the file.
  [[nodiscard]] Result<void> complete() const;

  std::filesystem::path path, target;  // as given, and with links resolved
  std::optional<struct stat> old;      // of the file to be replaced
  StagedFile staged;
  std::optional<RunningChecksum> written;  // of the bytes of write(), if it was called
  std::uint64_t written_bytes = 0;
};

/// Copies owner, group and permissions (no setuid, setgid and sticky bits) to an open file or folder. Only
/// root can keep another owner. If the group cannot be kept, the new group gets the permissions of others.
/// False, with errno set, on failure.
[[nodiscard]] bool keep_owner_and_mode(int descriptor, const struct stat& old);

}  // namespace splatlas
