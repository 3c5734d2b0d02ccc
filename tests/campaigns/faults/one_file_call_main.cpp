// splatlas-one-file-call CALL: one system call on files of the working folder, "in" and "out". Prints its
// result, or minus the error number. For tests of the supervisor.

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

constexpr std::size_t kBytes = 100;
constexpr long kAt = 20;
constexpr int kFchmodat2 = 452;

long call(std::string_view name) {
  const int in = ::open("in", O_RDONLY | O_CLOEXEC), out = ::open("out", O_RDWR | O_CLOEXEC);
  std::array<char, kBytes> bytes{};
  bytes.fill('x');
  std::array<iovec, 3> parts{
      iovec{bytes.data(), 10}, {bytes.data() + 10, 0}, {bytes.data() + 10, kBytes - 10}};
  if (name == "read") return ::syscall(SYS_read, in, bytes.data(), kBytes);
  if (name == "pread") return ::syscall(SYS_pread64, in, bytes.data(), kBytes, kAt);
  if (name == "readv") return ::syscall(SYS_readv, in, parts.data(), parts.size());
  if (name == "preadv") return ::syscall(SYS_preadv, in, parts.data(), parts.size(), kAt, 0L);
  if (name == "preadv2") return ::syscall(SYS_preadv2, in, parts.data(), parts.size(), -1L, -1L, 0L);
  if (name == "write") return ::syscall(SYS_write, out, bytes.data(), kBytes);
  if (name == "pwrite") return ::syscall(SYS_pwrite64, out, bytes.data(), kBytes, kAt);
  if (name == "writev") return ::syscall(SYS_writev, out, parts.data(), parts.size());
  if (name == "pwritev") return ::syscall(SYS_pwritev, out, parts.data(), parts.size(), kAt, 0L);
  if (name == "pwritev2") return ::syscall(SYS_pwritev2, out, parts.data(), parts.size(), -1L, -1L, 0L);
  if (name == "sendfile") return ::syscall(SYS_sendfile, out, in, nullptr, kBytes);
  if (name == "copy_file_range") return ::syscall(SYS_copy_file_range, in, nullptr, out, nullptr, kBytes, 0);
  if (name == "fchmodat2") return ::syscall(kFchmodat2, AT_FDCWD, "out", 0600, 0);
  if (name == "utimensat") return ::syscall(SYS_utimensat, AT_FDCWD, "out", nullptr, 0L);
  if (name == "utimensat of a descriptor") return ::syscall(SYS_utimensat, out, nullptr, nullptr, 0);
  if (name == "openat2") {
    const std::array<std::uint64_t, 3> how{O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600, 0};
    return ::syscall(SYS_openat2, AT_FDCWD, "new", how.data(), sizeof how);
  }
  if (name == "mmap") {
    void* const mapped = ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, out, 0);
    return mapped == MAP_FAILED ? -1 : 1;
  }
  if (name == "mmap for reading") {
    void* const mapped = ::mmap(nullptr, kBytes, PROT_READ, MAP_SHARED, in, 0);
    return mapped == MAP_FAILED ? -1 : 1;
  }
  errno = ENOSYS;
  return -1;
}

}  // namespace

int main(int argc, char** argv) {
  const long result = call(argc > 1 ? argv[1] : "");
  std::printf("%ld", result < 0 ? -static_cast<long>(errno) : result);
  return 0;
}
