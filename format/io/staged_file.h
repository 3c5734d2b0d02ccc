// Unfinished files and folders, invisible or under a random name, and their publication under a final name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <sys/stat.h>
#include <sys/types.h>

#include "format/io/checksum.h"
#include "format/io/interrupts.h"
#include "format/result.h"

namespace splatlas {

/// An open folder. Names are resolved in it even if it is moved or its path is replaced meanwhile.
class FolderHandle {
 public:
  FolderHandle() = default;
  ~FolderHandle();
  FolderHandle(FolderHandle&& other) noexcept;
  FolderHandle& operator=(FolderHandle&& other) noexcept;

  /// Opens a folder; the empty path is the current one. False, with errno set, on failure.
  [[nodiscard]] bool open(const std::filesystem::path& folder);
  /// Creates a folder in `parent` and opens it for reading. False, with errno set, on failure.
  [[nodiscard]] bool create(const FolderHandle& parent, const std::string& name, mode_t mode);
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Another handle of the folder. Closed on failure, with errno set.
  [[nodiscard]] FolderHandle duplicate() const;
  /// True if files in it can be without a name, and publish() can name them.
  [[nodiscard]] bool supports_unnamed_files() const;
  /// Syncs its names to the disk. Ignores file systems that cannot, and folders that may not be read.
  [[nodiscard]] bool sync() const;

 private:
  int descriptor_ = -1;
};

/// A new file in a folder. It has no name where the file system allows this (O_TMPFILE): the kernel removes
/// it if the process ends in any way. Elsewhere it has a random name, ".splatlas-" and 32 digits, that only
/// this object removes: its destructor, and interrupts. Functions that return bool set errno on failure.
class StagedFile {
 public:
  StagedFile() = default;
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  /// Creates the file with these permissions, less those of the umask. Call once.
  [[nodiscard]] bool create(FolderHandle folder, mode_t mode);

  /// Gives it its final name in `folder`, on the same file system, and replaces an old file there. An unnamed
  /// file that replaces one has a random name for the time of one system call.
  [[nodiscard]] bool publish(const FolderHandle& folder, const std::string& name);

  [[nodiscard]] const FolderHandle& folder() const { return folder_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }  ///< open for reading and writing
  /// A path to the open file, for libraries that open files by name: "/proc/self/fd/N".
  [[nodiscard]] std::filesystem::path path() const;

 private:
  [[nodiscard]] bool create_named(mode_t mode);
  void remove_name();

  FolderHandle folder_;
  int descriptor_ = -1;
  std::string random_name_;  // empty while it has none
  std::optional<RemoveOnInterrupt> remove_on_interrupt_;
};

/// A name for temporaries that nobody else takes: ".splatlas-" and 128 random bits.
[[nodiscard]] std::string random_name();

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
