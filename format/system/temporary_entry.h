// Locked temporary files and folders, their durable renames, and removal of stale ones.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "format/result.h"
#include "format/system/interrupts.h"

namespace splatlas {

/// A new file or folder ".splatlas-PROCESS-NUMBER[ENDING]", locked (flock) during the object's lifetime to
/// distinguish it from stale entries. The destructor removes it with its content, unless it was renamed.
/// Interrupts remove files, too.
class TemporaryEntry {
 public:
  enum class Kind { kFile, kFolder };

  TemporaryEntry() = default;
  ~TemporaryEntry();
  TemporaryEntry(const TemporaryEntry&) = delete;
  TemporaryEntry& operator=(const TemporaryEntry&) = delete;

  /// Creates the entry under an unused name. Call once. False, with errno set, on failure.
  [[nodiscard]] bool make(const std::filesystem::path& folder, Kind kind, std::string_view ending = "");
  /// Reopens the path if a library has replaced the file there. False, with errno set, on failure.
  [[nodiscard]] bool follow_name();
  /// Renames it to its final name. False, with errno set, on failure.
  [[nodiscard]] bool rename_to(const std::filesystem::path& target);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Open for reading and writing; read-only for folders and after follow_name() reopened the file.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  [[nodiscard]] bool create(Kind kind);

  std::filesystem::path path_;
  int descriptor_ = -1;
  bool exists_ = false;
  std::optional<RemoveOnInterrupt> remove_on_interrupt_;
};

/// Removes stale temporaries in a folder (empty path: the current one): entries with a name as above that
/// belong to the user, are not locked, and have no living process. Keeps doubtful entries. Ignores errors.
void remove_stale_temporaries(const std::filesystem::path& folder);

/// Syncs the folder of the renamed, complete file `target`. Messages call it `path`.
[[nodiscard]] Result<void> sync_folder_of(const std::filesystem::path& target,
                                          const std::filesystem::path& path);

}  // namespace splatlas
