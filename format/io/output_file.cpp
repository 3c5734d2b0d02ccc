#include "format/io/output_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/io/checksum.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr int kEnding = -1000;
std::atomic<int> deferred{0};  // kEnding while a handler removes files
std::atomic<int> waiting_signal{0};
std::recursive_mutex one_thread;
// Files and empty folders that handlers remove while nothing is deferred. Outlives the other static objects.
std::set<std::string>& to_remove = *new std::set<std::string>;

void end_unless_deferred() {
  int none = 0;
  const int signal = waiting_signal;
  if (signal == 0 || !deferred.compare_exchange_strong(none, kEnding)) return;
  for (auto path = to_remove.rbegin(); path != to_remove.rend(); ++path) std::remove(path->c_str());
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

extern "C" void handle_interrupt(int signal) {
  waiting_signal = signal;
  end_unless_deferred();
}

/// Defers interrupts during its lifetime. One thread at a time has one, or several.
class DeferInterrupts {
 public:
  DeferInterrupts() {
    while (deferred.fetch_add(1) < 0) ::pause();  // a handler on another thread ends the process
  }
  ~DeferInterrupts() {
    --deferred;
    lock_.unlock();
    end_unless_deferred();
  }

 private:
  std::unique_lock<std::recursive_mutex> lock_{one_thread};
};

/// Copies owner, group and permissions (no setuid, setgid and sticky bits). Only root can keep another owner.
/// If the group cannot be kept, the new group gets the permissions of others. False on failure.
bool keep_owner_and_mode(int descriptor, const struct stat& old) {
  mode_t mode = old.st_mode & 0777;
  if (::fchown(descriptor, old.st_uid, old.st_gid) != 0 &&
      ::fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) != 0)
    mode = (mode & ~S_IRWXG) | (mode & S_IRWXO) << 3;
  return ::fchmod(descriptor, mode) == 0;
}

fs::path random_name_beside(const fs::path& target) {
  std::random_device random;
  return target.parent_path() / fmt::format(".splatlas-{:08x}{:08x}", random(), random());
}

/// The effective user decides, as for the later write.
Result<void> check_access(const fs::path& path, const fs::path& of, int mode) {
  if (::faccessat(AT_FDCWD, of.c_str(), mode, AT_EACCESS) == 0) return {};
  return cannot_write(path, std::strerror(errno));
}

Result<void> check_folder_of(const fs::path& path) {
  const fs::path target = resolve_output(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  std::error_code error;
  if (fs::is_directory(folder, error)) return check_access(path, folder, W_OK | X_OK);
  return cannot_write(path, fmt::format("there is no folder {}", folder.string()));
}

}  // namespace

/// A new file or folder, and its target. `temporary` may change only during DeferInterrupts.
struct Unfinished {
  /// Finds the old file or folder at `target`, and creates the new one as `temporary`.
  [[nodiscard]] static Result<std::shared_ptr<Unfinished>> create(const fs::path& path,
                                                                  const fs::path& target, fs::path temporary,
                                                                  bool is_folder = false) {
    auto made = std::make_shared<Unfinished>();
    made->path = path;
    made->target = target;
    if (struct stat old{}; ::stat(target.c_str(), &old) == 0) made->old = old;
    const mode_t mode = (made->old ? 0700 : 0777) & (is_folder ? 0777 : 0666);
    const int flags = O_CLOEXEC | (is_folder ? O_RDONLY | O_DIRECTORY : O_RDWR | O_CREAT | O_EXCL);
    const DeferInterrupts until_registered;
    const auto listed = to_remove.insert(temporary.native()).first;  // may throw, so before the file exists
    const bool has_folder = is_folder && ::mkdir(temporary.c_str(), mode) == 0;
    if (has_folder || !is_folder) made->descriptor = ::open(temporary.c_str(), flags, mode);
    if (has_folder || made->descriptor >= 0) {
      made->temporary = std::move(temporary);
    } else {
      to_remove.erase(listed);
    }
    if (made->descriptor < 0) return made->error();
    return made;
  }

  ~Unfinished() {
    if (descriptor >= 0) ::close(descriptor);
    const DeferInterrupts until_removed;
    if (!temporary.empty()) std::remove(temporary.c_str());
    keep();
  }

  /// Sets owner and permissions, syncs the file, and verifies the bytes of write().
  [[nodiscard]] Result<void> complete() {
    if ((old && !keep_owner_and_mode(descriptor, *old)) || ::fsync(descriptor) != 0) return error();
    if (written) SPLATLAS_RETURN_IF_ERROR(read_back());
    ::close(std::exchange(descriptor, -1));
    return {};
  }

  [[nodiscard]] Result<void> read_back() const {
    // Drop cached pages, so that reads come from the disk if possible.
    ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
    RunningChecksum read;
    std::vector<std::byte> piece(std::size_t{1} << 20);
    ssize_t got = 0;
    for (off_t at = 0; (got = ::pread(descriptor, piece.data(), piece.size(), at)) > 0; at += got) {
      if (is_task_stopped()) throw Cancelled();
      read.add(std::span(piece).first(static_cast<std::size_t>(got)));
    }
    if (got < 0) return error();
    if (read.value() == written->value()) return {};
    return cannot_write(path, "other bytes come back from the disk than were written");
  }

  [[nodiscard]] Result<void> publish() {
    if (::rename(temporary.c_str(), target.c_str()) != 0) return error();
    keep();
    return {};
  }
  void keep() {
    to_remove.erase(temporary.native());
    temporary.clear();
  }

  /// Ignores file systems that cannot, and folders that may be written and not read.
  [[nodiscard]] Result<void> sync_parent() const {
    const int folder = ::open(target.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool synced =
        folder < 0 ? errno == EACCES : ::fsync(folder) == 0 || errno == EINVAL || errno == ENOTSUP;
    const std::string reason = std::strerror(errno);
    if (folder >= 0) ::close(folder);
    if (synced) return {};
    return fail(ErrorCode::kFailed, "{}: is written whole, but its folder cannot be synced: {}",
                path.string(), reason);
  }

  [[nodiscard]] tl::unexpected<Error> error() const { return cannot_write(path, std::strerror(errno)); }

  std::shared_ptr<Unfinished> parent;  // the folder of this file, to be removed after it
  fs::path path, target;               // as given, and with links resolved
  fs::path temporary;                  // empty for none
  std::optional<struct stat> old;      // of the target
  int descriptor = -1;
  std::optional<RunningChecksum> written;  // of the bytes of write(), if it was called
};

void install_interrupt_handlers() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(signal, handle_interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
  // Beyond the file size limit (ulimit -f), writes fail instead of ending the process.
  std::signal(SIGXFSZ, SIG_IGN);
}

Result<OutputFile> OutputFile::create(const fs::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(path));
  OutputFile output;
  const fs::path target = resolve_output(path);
  SPLATLAS_ASSIGN_OR_RETURN(output.file_, Unfinished::create(path, target, random_name_beside(target)));
  return output;
}

fs::path OutputFile::temporary() const {
  return file_->temporary;
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
  if (!file_->written) file_->written.emplace();
  constexpr std::size_t kPiece = std::size_t{1} << 23;  // takes milliseconds
  while (!bytes.empty()) {
    if (is_task_stopped()) throw Cancelled();
    const ssize_t written = ::write(file_->descriptor, bytes.data(), std::min(bytes.size(), kPiece));
    if (written < 0) return file_->error();
    file_->written->add(bytes.first(static_cast<std::size_t>(written)));
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> commit_files(std::span<OutputFile> files) {
  for (const OutputFile& output : files) SPLATLAS_RETURN_IF_ERROR(output.file_->complete());
  const DeferInterrupts all_or_none;
  for (const OutputFile& output : files) SPLATLAS_RETURN_IF_ERROR(output.file_->publish());
  for (const OutputFile& output : files) SPLATLAS_RETURN_IF_ERROR(output.file_->sync_parent());
  return {};
}

Result<void> add_file(const fs::path& path, std::span<const std::byte> bytes,
                      std::vector<OutputFile>& files) {
  SPLATLAS_ASSIGN_OR_RETURN(files.emplace_back(), OutputFile::create(path));
  return files.back().write(bytes);
}

Result<void> write_file(const fs::path& path, std::span<const std::byte> bytes) {
  std::vector<OutputFile> files;
  SPLATLAS_RETURN_IF_ERROR(add_file(path, bytes, files));
  return commit_files(files);
}

Result<OutputFolder> OutputFolder::create(const fs::path& path) {
  SPLATLAS_RETURN_IF_ERROR(check_writable_folder(path));
  OutputFolder output;
  const fs::path target = resolve_output((path / "").parent_path());
  SPLATLAS_ASSIGN_OR_RETURN(output.folder_,
                            Unfinished::create(path, target, random_name_beside(target), true));
  return output;
}

Result<void> OutputFolder::add(const std::string& name,
                               const std::function<Result<void>(OutputFile&)>& write) {
  OutputFile output;
  SPLATLAS_ASSIGN_OR_RETURN(output.file_, Unfinished::create(folder_->path / name, folder_->target / name,
                                                             folder_->temporary / name));
  output.file_->parent = folder_;
  files_.push_back(output);
  SPLATLAS_RETURN_IF_ERROR(write(output));
  return output.file_->complete();
}

Result<void> OutputFolder::commit() {
  SPLATLAS_RETURN_IF_ERROR(folder_->complete());
  const DeferInterrupts all_or_none;
  SPLATLAS_RETURN_IF_ERROR(folder_->publish());
  for (const OutputFile& output : files_) output.file_->keep();
  return folder_->sync_parent();
}

fs::path resolve_output(const fs::path& path) {
  constexpr int kMaxLinks = 40;  // limit of the Linux kernel
  fs::path target = path;
  std::error_code error;
  for (int n = 0; n < kMaxLinks && fs::is_symlink(fs::symlink_status(target, error)); ++n) {
    const fs::path link = fs::read_symlink(target, error);
    if (error) return target;
    target = target.parent_path() / link;  // `link` if it is absolute
  }
  const fs::path folder = fs::canonical(target.has_parent_path() ? target.parent_path() : ".", error);
  return error ? target : folder / target.filename();
}

tl::unexpected<Error> cannot_write(const fs::path& path, std::string_view reason) {
  return fail(ErrorCode::kFailed, "{}: cannot be written: {}", path.string(), reason);
}

Result<void> check_writable_file(const fs::path& path) {
  if (path.empty()) return fail(ErrorCode::kUsage, "\"\": the output must have a name");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) return cannot_write(path, error.message());
  if (path.filename().empty() || fs::is_directory(status)) return cannot_write(path, "it is a folder");
  if (fs::exists(status)) {
    if (!fs::is_regular_file(status)) return cannot_write(path, "it is not a regular file");
    SPLATLAS_RETURN_IF_ERROR(check_access(path, path, W_OK));
  }
  return check_folder_of(path);
}

Result<void> check_writable_folder(const fs::path& path) {
  const fs::path target = (path / "").parent_path();
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (status.type() == fs::file_type::none) return cannot_write(path, error.message());
  if (fs::exists(status) && !(fs::is_directory(status) && fs::is_empty(target, error)))
    return cannot_write(path, "it exists and is not an empty folder; name a new one");
  return check_folder_of(target);
}

Result<void> check_outputs(std::span<const fs::path> outputs, std::span<const fs::path> inputs) {
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    const fs::path& output = outputs[n];
    const auto same = [&](const fs::path& other) {
      if (output.empty() || other.empty()) return false;
      std::error_code none;
      return fs::equivalent(output, other, none) || resolve_output(output) == resolve_output(other);
    };
    if (const auto input = std::ranges::find_if(inputs, same); input != inputs.end())
      return fail(ErrorCode::kUsage, "{}: is an input ({}); write to another file", output.string(),
                  input->string());
    if (const auto other = std::ranges::find_if(outputs.first(n), same); other != outputs.begin() + n)
      return fail(ErrorCode::kUsage, "{}: is another output, too ({}); write to two files", output.string(),
                  other->string());
  }
  return {};
}

}  // namespace splatlas
