// System calls on files, and the selection of those on the files of one folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <linux/seccomp.h>

namespace splatlas {

/// System call of a traced process on the folder or a file in it.
struct FileCall {
  enum class Effect : std::uint8_t {
    kReads,
    kStores,   ///< may fail on a full disk: writes, new names, syncs
    kChanges,  ///< the rest: removes, closes, permissions
  };
  std::string name;
  Effect effect = Effect::kReads;
  bool transfers = false;     ///< reads or writes a buffer: may transfer less than requested
  bool has_position = false;  ///< ... at an explicit position
};

/// The numbers of all these system calls, for a seccomp filter.
[[nodiscard]] std::span<const int> file_call_numbers();

/// The call that a process is stopped in, if it concerns files of the folder. `folder` is canonical and the
/// working directory of the process.
[[nodiscard]] std::optional<FileCall> file_call_of(const seccomp_notif& request,
                                                   const std::filesystem::path& folder);

}  // namespace splatlas
