// The system calls that read or change files, and which of them are about the files of one folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <linux/seccomp.h>

namespace splatlas {

/// One system call of a watched program, on a file of the folder (or on the folder).
struct FileCall {
  enum class Effect : std::uint8_t {
    kReads,
    kStores,   ///< may find the disk full: writes, new names, syncs
    kChanges,  ///< the rest: removes, closes, permissions
  };
  std::string name;
  Effect effect = Effect::kReads;
  bool transfers = false;     ///< read and write with a buffer: may do less than asked
  bool has_position = false;  ///< ... at a position of its own
};

/// The numbers of all these calls, for a filter.
[[nodiscard]] std::span<const int> file_call_numbers();

/// The call that a process waits in, when it is about the folder's files. `folder` is canonical, and the
/// process's working directory.
[[nodiscard]] std::optional<FileCall> file_call_of(const seccomp_notif& request,
                                                   const std::filesystem::path& folder);

}  // namespace splatlas
