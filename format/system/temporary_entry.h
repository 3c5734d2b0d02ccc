// Files and folders under a temporary name, and what is left of those whose writers died.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "format/system/interrupts.h"

namespace splatlas {

/// A new file or folder ".splatlas-PROCESS-NUMBER[ENDING]", locked (flock) while this exists, so that others
/// can tell it from one whose writer died. Removed with all that is in it when this ends before it was
/// renamed; files on interrupts, too.
class TemporaryEntry {
 public:
  enum class Kind { kFile, kFolder };

  TemporaryEntry() = default;
  ~TemporaryEntry();
  TemporaryEntry(const TemporaryEntry&) = delete;
  TemporaryEntry& operator=(const TemporaryEntry&) = delete;

  /// Once. Takes a name that nobody has. false: it cannot be made; errno has the reason.
  [[nodiscard]] bool make(const std::filesystem::path& folder, Kind kind, std::string_view ending = "");
  /// Opens what has the name now, where whoever wrote to the path put another file there. errno has the
  /// reason.
  [[nodiscard]] bool follow_name();
  /// Gives it its lasting name. errno has the reason.
  [[nodiscard]] bool rename_to(const std::filesystem::path& target);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Files: for reading and writing (reading, after another file was put there). Folders: for syncing.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  [[nodiscard]] bool create(Kind kind);

  std::filesystem::path path_;
  int descriptor_ = -1;
  bool exists_ = false;
  std::optional<RemoveOnInterrupt> remove_on_interrupt_;
};

/// Removes temporaries in a folder (the current one for an empty path) whose writers are surely dead: named
/// as above, the user's own, locked by nobody, and of no other process that is alive. What cannot be told
/// stays, as does what cannot be removed.
void remove_stale_temporaries(const std::filesystem::path& folder);

}  // namespace splatlas
