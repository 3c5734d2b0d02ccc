// System calls on files, and the selection of those on the files of one folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <linux/seccomp.h>

namespace splatlas {

/// System call of a traced process on a file or folder.
struct FileCall {
  enum class Effect : std::uint8_t {
    kReads,
    kStores,   ///< may fail on a full disk: writes, new names, syncs
    kChanges,  ///< the rest: removes, closes, permissions
  };
  enum class NameUse : std::uint8_t {
    kNone,     ///< names are unchanged
    kCreates,  ///< `path` must not exist and is created
    kChanges,  ///< `path` is removed, renamed to `target`, or opened for writing
  };
  std::string name;
  Effect effect = Effect::kReads;
  bool transfers = false;     ///< reads or writes buffers: may transfer less than requested
  bool has_position = false;  ///< ... at an explicit position
  bool has_vectors = false;   ///< ... given by an array of iovec
  NameUse use = NameUse::kNone;
  std::filesystem::path path{}, target{};
  bool is_unnamed_file = false;  ///< creates a file without a name (O_TMPFILE)
};

/// The numbers of all these system calls, for a seccomp filter.
[[nodiscard]] std::span<const int> file_call_numbers();

/// The call that a process is stopped in. `folder` is its working directory, a canonical path. Nothing for
/// calls that fail to open a missing file for reading: the loader probes many names.
[[nodiscard]] std::optional<FileCall> file_call_of(const seccomp_notif& request,
                                                   const std::filesystem::path& folder);

/// True for the folder and everything below it.
[[nodiscard]] bool is_in(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace splatlas
