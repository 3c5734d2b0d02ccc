#include "tests/faults/file_calls.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using Effect = FileCall::Effect;

struct KnownCall {
  int number;
  const char* name;
  Effect effect;
  int path_argument;        ///< -1: the first argument is a descriptor
  int flags_argument = -1;  ///< of open calls: O_CREAT and others make them store
  bool transfers = false, has_position = false;
};

constexpr std::array kCalls{
#ifdef SYS_open
    KnownCall{SYS_open, "open", Effect::kReads, 0, 1},
    KnownCall{SYS_creat, "creat", Effect::kStores, 0},
    KnownCall{SYS_rename, "rename", Effect::kStores, 0},
    KnownCall{SYS_unlink, "unlink", Effect::kChanges, 0},
    KnownCall{SYS_mkdir, "mkdir", Effect::kStores, 0},
    KnownCall{SYS_rmdir, "rmdir", Effect::kChanges, 0},
    KnownCall{SYS_chmod, "chmod", Effect::kChanges, 0},
#endif
    KnownCall{SYS_openat, "openat", Effect::kReads, 1, 2},
    KnownCall{SYS_renameat, "renameat", Effect::kStores, 1},
    KnownCall{SYS_renameat2, "renameat2", Effect::kStores, 1},
    KnownCall{SYS_unlinkat, "unlinkat", Effect::kChanges, 1},
    KnownCall{SYS_mkdirat, "mkdirat", Effect::kStores, 1},
    KnownCall{SYS_fchmodat, "fchmodat", Effect::kChanges, 1},
    KnownCall{SYS_read, "read", Effect::kReads, -1, -1, true},
    KnownCall{SYS_pread64, "pread", Effect::kReads, -1, -1, true, true},
    KnownCall{SYS_readv, "readv", Effect::kReads, -1},
    KnownCall{SYS_getdents64, "getdents", Effect::kReads, -1},
    KnownCall{SYS_write, "write", Effect::kStores, -1, -1, true},
    KnownCall{SYS_pwrite64, "pwrite", Effect::kStores, -1, -1, true, true},
    KnownCall{SYS_writev, "writev", Effect::kStores, -1},
    KnownCall{SYS_fsync, "fsync", Effect::kStores, -1},
    KnownCall{SYS_fdatasync, "fdatasync", Effect::kStores, -1},
    KnownCall{SYS_ftruncate, "ftruncate", Effect::kStores, -1},
    KnownCall{SYS_fallocate, "fallocate", Effect::kStores, -1},
    KnownCall{SYS_fchmod, "fchmod", Effect::kChanges, -1},
    KnownCall{SYS_fchown, "fchown", Effect::kChanges, -1},
    KnownCall{SYS_close, "close", Effect::kChanges, -1},
};

/// The string at an address of another process; empty when there is none.
std::string text_at(pid_t process, std::uint64_t address) {
  std::array<char, 4096> text{};
  constexpr std::size_t kPage = 4096;  // the string may end right before an unmapped page
  std::size_t got = 0;
  while (got < text.size()) {
    iovec to{text.data() + got, std::min(text.size() - got, kPage - (address + got) % kPage)};
    iovec from{reinterpret_cast<void*>(address + got), to.iov_len};
    if (::process_vm_readv(process, &to, 1, &from, 1, 0) != static_cast<ssize_t>(to.iov_len)) return {};
    const auto end = std::find(text.begin() + static_cast<std::ptrdiff_t>(got),
                               text.begin() + static_cast<std::ptrdiff_t>(got + to.iov_len), '\0');
    got += to.iov_len;
    if (end != text.begin() + static_cast<std::ptrdiff_t>(got)) return {text.begin(), end};
  }
  return {};
}

bool is_in(const fs::path& path, const fs::path& folder) {
  const std::string &inner = path.native(), &outer = folder.native();
  return inner.starts_with(outer) && (inner.size() == outer.size() || inner[outer.size()] == '/');
}

fs::path file_of(const seccomp_notif& request, const KnownCall& call, const fs::path& folder) {
  const auto process = static_cast<pid_t>(request.pid);
  if (call.path_argument >= 0) {
    const auto argument = static_cast<std::size_t>(call.path_argument);
    const std::string text = text_at(process, request.data.args[argument]);
    return text.empty() ? fs::path() : folder / text;
  }
  std::error_code error;
  return fs::read_symlink(fmt::format("/proc/{}/fd/{}", process, static_cast<int>(request.data.args[0])),
                          error);
}

}  // namespace

std::span<const int> file_call_numbers() {
  static const std::vector<int> numbers = [] {
    std::vector<int> list;
    for (const KnownCall& call : kCalls) list.push_back(call.number);
    return list;
  }();
  return numbers;
}

std::optional<FileCall> file_call_of(const seccomp_notif& request, const fs::path& folder) {
  const auto call = std::ranges::find(kCalls, request.data.nr, &KnownCall::number);
  if (call == kCalls.end()) return std::nullopt;
  const fs::path file = file_of(request, *call, folder);
  if (!is_in(file, folder)) return std::nullopt;
  Effect effect = call->effect;
  if (call->flags_argument >= 0) {
    const auto flags = request.data.args[static_cast<std::size_t>(call->flags_argument)];
    if ((flags & (O_CREAT | O_TRUNC | O_WRONLY | O_RDWR)) != 0) effect = Effect::kStores;
  }
  // The loader probes many names for libraries.
  if (call->path_argument >= 0 && effect == Effect::kReads && !fs::exists(file)) return std::nullopt;
  return FileCall{call->name, effect, call->transfers, call->has_position};
}

}  // namespace splatlas
