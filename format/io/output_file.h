// Atomic replacement of files, atomic creation of folders, their removal by signals, and early checks of
// their paths: that they can be written, and are neither inputs nor other outputs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// Resolves links to the file that writing to `path` creates or replaces; the file need not exist. Absolute,
/// unless its folder does not exist.
[[nodiscard]] std::filesystem::path resolve_output(const std::filesystem::path& path);

/// kFailed: "PATH: cannot be written: " and the reason.
[[nodiscard]] tl::unexpected<Error> cannot_write(const std::filesystem::path& path, std::string_view reason);

/// Checks that a file can be created or replaced. kFailed, with the reason, if its folder is missing or
/// read-only, or if `path` is not a regular file; kUsage for an empty path. Changes nothing.
[[nodiscard]] Result<void> check_writable_file(const std::filesystem::path& path);

/// Checks that a folder can be created. It must not exist, or be empty. Errors as above.
[[nodiscard]] Result<void> check_writable_folder(const std::filesystem::path& path);

/// kUsage if an output is an input or another output, by any path or link. Ignores empty ones. Opens none.
[[nodiscard]] Result<void> check_outputs(std::span<const std::filesystem::path> outputs,
                                         std::span<const std::filesystem::path> inputs);

struct Unfinished;

/// A new file under a random name beside its target, ".splatlas-" and 16 digits. The target is unchanged
/// until commit_files() and on all errors. An uncommitted file is removed, unless the process is killed.
/// Follows links. Keeps permissions (without setuid, setgid and sticky bits), group and owner of the old file
/// if possible; nobody else can read the new one before. Other hard links keep the old file. All errors are
/// kFailed, with target and reason.
class OutputFile {
 public:
  /// Creates the empty file. Checks the target as check_writable_file() does.
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& path);
  /// Path to the unfinished file, for libraries that write to a path. Has no ending.
  [[nodiscard]] std::filesystem::path temporary() const;
  [[nodiscard]] Result<void> write(std::span<const std::byte> bytes);

 private:
  friend Result<void> commit_files(std::span<OutputFile> files);
  friend class OutputFolder;
  std::shared_ptr<Unfinished> file_;
};

/// Syncs the files, verifies the checksums of the bytes of write() by reading them back, gives all files
/// their targets' names, and syncs the folders. If only the last step fails, the targets are the new files,
/// and the message says so.
[[nodiscard]] Result<void> commit_files(std::span<OutputFile> files);

/// Creates and writes a file, and adds it to those that commit_files() names.
[[nodiscard]] Result<void> add_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                                    std::vector<OutputFile>& files);

/// Creates, writes and commits one file.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Files that become a new folder together. Until commit() its name is random, as that of an OutputFile.
class OutputFolder {
 public:
  /// Checks the target as check_writable_folder() does: it must not exist, or be empty.
  [[nodiscard]] static Result<OutputFolder> create(const std::filesystem::path& path);
  /// Creates a file of the folder, calls `write`, and syncs the file and verifies its bytes.
  [[nodiscard]] Result<void> add(const std::string& name,
                                 const std::function<Result<void>(OutputFile&)>& write);
  /// Syncs the folder and gives it the target's name; if possible, also permissions and owner of one there.
  [[nodiscard]] Result<void> commit();

 private:
  std::shared_ptr<Unfinished> folder_;
  std::vector<OutputFile> files_;
};

/// Installs handlers for SIGINT, SIGTERM and SIGHUP: they remove unfinished files and folders and end the
/// program with the default action. Ignored signals (nohup) stay ignored. Also ignores SIGXFSZ, so that
/// writes beyond the file size limit fail. Only for programs, not for libraries.
void install_interrupt_handlers();

}  // namespace splatlas
