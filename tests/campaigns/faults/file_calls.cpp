#include "tests/campaigns/faults/file_calls.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using Effect = FileCall::Effect;

using NameUse = FileCall::NameUse;

struct KnownCall {
  int number;
  const char* name;
  Effect effect;
  /// Arguments with the path and the folder that it is relative to; -1: the first argument is a descriptor.
  int path_argument = -1, folder_argument = -1;
  NameUse use = NameUse::kNone;
  int target_argument = -1, target_folder_argument = -1;  ///< of renames
  int flags_argument = -1;                                ///< of open calls: the flags determine the effect
  int descriptor_argument = 0;                            ///< without a path: the file
};

#ifdef SYS_fchmodat2
constexpr int kFchmodat2 = SYS_fchmodat2;
#else
constexpr int kFchmodat2 = 452;  // newer than the headers; the same on all architectures
#endif

constexpr KnownCall without_path(int number, const char* name, Effect effect, int descriptor_argument = 0) {
  return {number, name, effect, -1, -1, NameUse::kNone, -1, -1, -1, descriptor_argument};
}

constexpr std::array kCalls{
#ifdef SYS_open
    KnownCall{SYS_open, "open", Effect::kReads, 0, -1, NameUse::kNone, -1, -1, 1},
    KnownCall{SYS_creat, "creat", Effect::kStores, 0, -1, NameUse::kChanges},
    KnownCall{SYS_rename, "rename", Effect::kStores, 0, -1, NameUse::kChanges, 1},
    KnownCall{SYS_unlink, "unlink", Effect::kChanges, 0, -1, NameUse::kChanges},
    KnownCall{SYS_mkdir, "mkdir", Effect::kStores, 0, -1, NameUse::kCreates},
    KnownCall{SYS_rmdir, "rmdir", Effect::kChanges, 0, -1, NameUse::kChanges},
    KnownCall{SYS_chmod, "chmod", Effect::kChanges, 0, -1, NameUse::kChanges},
    KnownCall{SYS_chown, "chown", Effect::kChanges, 0, -1, NameUse::kChanges},
    KnownCall{SYS_link, "link", Effect::kStores, 1, -1, NameUse::kCreates},
    KnownCall{SYS_symlink, "symlink", Effect::kStores, 1, -1, NameUse::kCreates},
#endif
    KnownCall{SYS_openat, "openat", Effect::kReads, 1, 0, NameUse::kNone, -1, -1, 2},
    KnownCall{SYS_openat2, "openat2", Effect::kReads, 1, 0},
    KnownCall{SYS_renameat, "renameat", Effect::kStores, 1, 0, NameUse::kChanges, 3, 2},
    KnownCall{SYS_renameat2, "renameat2", Effect::kStores, 1, 0, NameUse::kChanges, 3, 2},
    KnownCall{SYS_linkat, "linkat", Effect::kStores, 3, 2, NameUse::kCreates},
    KnownCall{SYS_symlinkat, "symlinkat", Effect::kStores, 2, 1, NameUse::kCreates},
    KnownCall{SYS_unlinkat, "unlinkat", Effect::kChanges, 1, 0, NameUse::kChanges},
    KnownCall{SYS_mkdirat, "mkdirat", Effect::kStores, 1, 0, NameUse::kCreates},
    KnownCall{SYS_fchmodat, "fchmodat", Effect::kChanges, 1, 0, NameUse::kChanges},
    KnownCall{kFchmodat2, "fchmodat2", Effect::kChanges, 1, 0, NameUse::kChanges},
    KnownCall{SYS_utimensat, "utimensat", Effect::kChanges, 1, 0, NameUse::kChanges},
    KnownCall{SYS_fchownat, "fchownat", Effect::kChanges, 1, 0, NameUse::kChanges},
    KnownCall{SYS_truncate, "truncate", Effect::kStores, 0, -1, NameUse::kChanges},
    without_path(SYS_read, "read", Effect::kReads),
    without_path(SYS_pread64, "pread", Effect::kReads),
    without_path(SYS_readv, "readv", Effect::kReads),
    without_path(SYS_preadv, "preadv", Effect::kReads),
    without_path(SYS_preadv2, "preadv2", Effect::kReads),
    without_path(SYS_getdents64, "getdents", Effect::kReads),
    without_path(SYS_write, "write", Effect::kStores),
    without_path(SYS_pwrite64, "pwrite", Effect::kStores),
    without_path(SYS_writev, "writev", Effect::kStores),
    without_path(SYS_pwritev, "pwritev", Effect::kStores),
    without_path(SYS_pwritev2, "pwritev2", Effect::kStores),
    without_path(SYS_sendfile, "sendfile", Effect::kStores),
    without_path(SYS_copy_file_range, "copy_file_range", Effect::kStores, 2),
    without_path(SYS_mmap, "mmap", Effect::kStores, 4),
    without_path(SYS_fsync, "fsync", Effect::kStores),
    without_path(SYS_fdatasync, "fdatasync", Effect::kStores),
    without_path(SYS_ftruncate, "ftruncate", Effect::kStores),
    without_path(SYS_fallocate, "fallocate", Effect::kStores),
    without_path(SYS_fchmod, "fchmod", Effect::kChanges),
    without_path(SYS_fchown, "fchown", Effect::kChanges),
    without_path(SYS_close, "close", Effect::kChanges),
};

bool is_one_of(int number, std::initializer_list<int> numbers) {
  return std::ranges::find(numbers, number) != numbers.end();
}
bool has_position(int number) {
  return is_one_of(number, {SYS_pread64, SYS_pwrite64, SYS_preadv, SYS_preadv2, SYS_pwritev, SYS_pwritev2});
}
bool has_vectors(int number) {
  return is_one_of(number, {SYS_readv, SYS_preadv, SYS_preadv2, SYS_writev, SYS_pwritev, SYS_pwritev2});
}
bool transfers(int number) {
  return is_one_of(number, {SYS_read, SYS_write}) || has_position(number) || has_vectors(number);
}
/// Only shared mappings for writing change a file.
bool maps_for_writing(const seccomp_notif& request) {
  return (request.data.args[2] & PROT_WRITE) != 0 && (request.data.args[3] & MAP_TYPE) != MAP_PRIVATE &&
         (request.data.args[3] & MAP_ANONYMOUS) == 0;
}

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

fs::path path_of_descriptor(const seccomp_notif& request, int argument) {
  std::error_code error;
  const auto descriptor = static_cast<int>(request.data.args[static_cast<std::size_t>(argument)]);
  return fs::read_symlink(fmt::format("/proc/{}/fd/{}", request.pid, descriptor), error);
}

/// Flags of an openat2() call, the first field of its struct open_how.
std::uint64_t flags_of_openat2(const seccomp_notif& request) {
  std::uint64_t flags = 0;
  iovec to{&flags, sizeof flags}, from{reinterpret_cast<void*>(request.data.args[2]), sizeof flags};
  static_cast<void>(::process_vm_readv(static_cast<pid_t>(request.pid), &to, 1, &from, 1, 0));
  return flags;
}

/// Path of an argument; relative to the folder of another argument, or to the working directory. utimensat()
/// without a path means that folder's descriptor itself.
fs::path path_of(const seccomp_notif& request, int argument, int folder_argument, const fs::path& folder) {
  if (request.data.nr == SYS_utimensat && request.data.args[static_cast<std::size_t>(argument)] == 0)
    return path_of_descriptor(request, folder_argument);
  const std::string text =
      text_at(static_cast<pid_t>(request.pid), request.data.args[static_cast<std::size_t>(argument)]);
  if (text.empty()) return {};
  const bool is_relative_to_folder =
      folder_argument >= 0 &&
      static_cast<int>(request.data.args[static_cast<std::size_t>(folder_argument)]) != AT_FDCWD;
  return ((is_relative_to_folder ? path_of_descriptor(request, folder_argument) : folder) / text)
      .lexically_normal();
}

/// Effects of an open call by its flags.
void apply_flags(FileCall& call, int flags) {
  constexpr int kUnnamed = O_TMPFILE & ~O_DIRECTORY;
  call.is_unnamed_file = (flags & kUnnamed) != 0;
  if ((flags & (O_CREAT | O_TRUNC | O_WRONLY | O_RDWR)) == 0 && !call.is_unnamed_file) return;
  call.effect = Effect::kStores;
  if (call.is_unnamed_file) return;
  call.use = (flags & (O_CREAT | O_EXCL)) == (O_CREAT | O_EXCL) ? NameUse::kCreates : NameUse::kChanges;
}

}  // namespace

bool is_in(const fs::path& path, const fs::path& folder) {
  const std::string &inner = path.native(), &outer = folder.native();
  return inner.starts_with(outer) && (inner.size() == outer.size() || inner[outer.size()] == '/');
}

std::span<const int> file_call_numbers() {
  static const std::vector<int> numbers = [] {
    std::vector<int> list;
    for (const KnownCall& call : kCalls) list.push_back(call.number);
    return list;
  }();
  return numbers;
}

std::optional<FileCall> file_call_of(const seccomp_notif& request, const fs::path& folder) {
  const auto known = std::ranges::find(kCalls, request.data.nr, &KnownCall::number);
  if (known == kCalls.end() || (known->number == SYS_mmap && !maps_for_writing(request))) return std::nullopt;
  FileCall call{.name = known->name,
                .effect = known->effect,
                .transfers = transfers(known->number),
                .has_position = has_position(known->number),
                .has_vectors = has_vectors(known->number),
                .use = known->use};
  const bool has_path = known->path_argument >= 0;
  call.path = has_path ? path_of(request, known->path_argument, known->folder_argument, folder)
                       : path_of_descriptor(request, known->descriptor_argument);
  if (known->target_argument >= 0)
    call.target = path_of(request, known->target_argument, known->target_folder_argument, folder);
  if (known->flags_argument >= 0) {
    apply_flags(call, static_cast<int>(request.data.args[static_cast<std::size_t>(known->flags_argument)]));
  }
  if (known->number == SYS_openat2) apply_flags(call, static_cast<int>(flags_of_openat2(request)));
  if (has_path && call.effect == Effect::kReads && !fs::exists(call.path)) return std::nullopt;
  std::error_code error;
  const bool exists = fs::exists(fs::symlink_status(call.path, error));
  if (call.use == NameUse::kCreates && exists) call.use = NameUse::kNone;  // the call fails
  return call;
}

}  // namespace splatlas
