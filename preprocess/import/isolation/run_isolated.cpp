#include "preprocess/import/isolation/run_isolated.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <new>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "format/io/memory_limit.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr int kAnswered = 42, kExited = 43, kOutOfMemory = 44, kThrown = 45, kNotWritten = 46;

struct Shared {
  std::atomic<std::uint32_t> beats{0};
  std::array<char, 1024> file{};  ///< the file being read; empty at first
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

Shared* shared_of_this_child = nullptr;

/// Anonymous memory that both processes see; null if there is none.
auto make_shared_page() {
  void* const at = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  const auto unmap = [](Shared* page) { ::munmap(page, sizeof(Shared)); };
  return std::unique_ptr<Shared, decltype(unmap)>(at == MAP_FAILED ? nullptr : new (at) Shared);
}

constexpr bool kSanitized =
#ifdef SPLATLAS_SANITIZED
    true;  // sanitizers map terabytes
#else
    false;
#endif

void limit(int resource, rlim_t value) {
  rlimit current{};
  ::getrlimit(static_cast<__rlimit_resource>(resource), &current);
  const rlimit lower{std::min(value, current.rlim_max), std::min(value, current.rlim_max)};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &lower);
}

/// Bytes of address space that this process has mapped.
std::uint64_t mapped_bytes() {
  unsigned long long pages = 0;
  if (std::FILE* const file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%llu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

[[noreturn]] void exit_in_library() {
  ::_exit(kExited);
}

/// Separates the child from the parent's signals, terminal, output and exit handlers, and limits it.
void prepare_child(pid_t parent, const ChildLimits& limits) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kExited);
  // exit() inside a library would run the parent's handlers, and remove its files.
  if (std::atexit(exit_in_library) != 0) ::_exit(kExited);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL})
    ::signal(signal, SIG_DFL);
  ::signal(SIGXFSZ, SIG_IGN);  // a write fails instead
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
  limit(RLIMIT_CORE, 0);
  if (!kSanitized) {
    limit(RLIMIT_FSIZE, limits.bytes);
    limit(RLIMIT_AS, mapped_bytes() + limits.bytes);
  }
}

[[noreturn]] void answer_as_child(const std::function<bool(std::FILE*)>& answer, std::FILE* file) {
  try {
    ::_exit(answer(file) ? kAnswered : kNotWritten);
  } catch (const std::bad_alloc&) {
    ::_exit(kOutOfMemory);
  } catch (...) {
    ::_exit(kThrown);
  }
}

double seconds_of(clockid_t clock) {
  timespec time{};
  if (::clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Waits for the end of a child for up to 50 ms; it stays waitable. Without `handle` (old kernels) it polls.
bool has_ended(pid_t child, int handle) {
  pollfd ended{handle, POLLIN, 0};
  if (handle >= 0) return ::poll(&ended, 1, 50) == 1;
  ::usleep(2000);
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
         info.si_pid == child;
}

/// Children can be waited for during its lifetime, even if the caller ignores SIGCHLD.
class WaitableChildren {
 public:
  WaitableChildren() {
    struct sigaction action {};
    action.sa_handler = SIG_DFL;
    ::sigaction(SIGCHLD, &action, &before_);
  }
  ~WaitableChildren() { ::sigaction(SIGCHLD, &before_, nullptr); }
  WaitableChildren(const WaitableChildren&) = delete;
  WaitableChildren& operator=(const WaitableChildren&) = delete;

 private:
  struct sigaction before_ {};
};

/// Waits until the child ends, or exceeds a time limit: then returns that, in seconds, else 0. A child that
/// has ended stays waitable.
double watch(pid_t child, const Shared& shared, const ChildLimits& limits) {
  const int handle = static_cast<int>(::syscall(SYS_pidfd_open, child, 0));
  clockid_t child_clock{};
  ::clock_getcpuclockid(child, &child_clock);
  std::uint32_t beats = 0;
  double cpu_begun = 0, wall_begun = seconds_of(CLOCK_MONOTONIC);
  double exceeded = 0;
  while (!(exceeded > 0) && !has_ended(child, handle)) {
    const double cpu = seconds_of(child_clock), wall = seconds_of(CLOCK_MONOTONIC);
    if (const std::uint32_t now = shared.beats.load(); now != beats) {
      beats = now;
      cpu_begun = cpu;
      wall_begun = wall;
    }
    if (cpu - cpu_begun > limits.cpu_seconds) exceeded = limits.cpu_seconds;
    if (wall - wall_begun > limits.wall_seconds) exceeded = limits.wall_seconds;
  }
  if (handle >= 0) ::close(handle);
  return exceeded;
}

/// The child's last file, or `path`.
fs::path file_read(const Shared& shared, const fs::path& path) {
  const std::size_t length = ::strnlen(shared.file.data(), shared.file.size());
  return length > 0 ? fs::path(std::string(shared.file.data(), length)) : path;
}

Result<void> check_end(int status, double exceeded, const ChildLimits& limits, const fs::path& file) {
  if (exceeded > 0)
    return bad_file(
        file, "reading it took more than {:.0f} seconds without progress; it is damaged, or made to be slow",
        exceeded);
  if (WIFSIGNALED(status))
    return bad_file(file, "its reader crashed (signal {}); the file is damaged", WTERMSIG(status));
  switch (WEXITSTATUS(status)) {
    case kAnswered: return {};
    case kOutOfMemory:
    case kNotWritten:
      return fail(ErrorCode::kLimit,
                  "{}: reading it needs more than {} MiB, which no valid file of its size does",
                  file.string(), limits.bytes >> 20);
    default: return bad_file(file, "its reader gave up; the file is damaged");
  }
}

}  // namespace

ChildLimits limits_for(const fs::path& path) {
  std::uint64_t bytes = 0;
  std::error_code unreadable;
  for (const fs::path& file : regular_files_of(path, unreadable)) {
    const auto size = fs::file_size(file, unreadable);
    if (!unreadable) bytes += size;
  }
  constexpr std::uint64_t kFloor = std::uint64_t{512} << 20,
                          kPerByte = 3300;  // three copies, deflated 1100 times
  constexpr double kSecondsPerByte = 2e-7;  // a volume deflated 50 times
  ChildLimits limits;
  limits.bytes = std::min(machine_memory() / 2, kFloor + kPerByte * std::min(bytes, std::uint64_t{1} << 40));
  limits.cpu_seconds += kSecondsPerByte * static_cast<double>(bytes);
  limits.wall_seconds += 5 * kSecondsPerByte * static_cast<double>(bytes);  // 1 MB/s
  return limits;
}

void report_child_progress(const fs::path& file) {
  if (shared_of_this_child == nullptr) return;
  std::array<char, 1024>& name = shared_of_this_child->file;
  std::strncpy(name.data(), file.c_str(), name.size() - 1);
  ++shared_of_this_child->beats;
}

Result<ChildAnswer> run_child(const fs::path& path, const ChildLimits& limits,
                              const std::function<bool(std::FILE* file)>& answer) {
  const WaitableChildren waitable;
  const auto page = make_shared_page();
  ChildAnswer file(::fdopen(::memfd_create("answer", MFD_CLOEXEC), "w+b"));
  if (page == nullptr || file == nullptr)
    return fail(ErrorCode::kLimit, "{}: no memory is left to read it", path.string());
  std::fflush(nullptr);  // else both processes write what is buffered
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) return bad_file(path, "no process could be started to read it ({})", std::strerror(errno));
  if (child == 0) {
    shared_of_this_child = page.get();
    prepare_child(parent, limits);
    answer_as_child(answer, file.get());
  }
  const double exceeded = watch(child, *page.get(), limits);
  ::kill(-child, SIGKILL);  // with its own children
  ::kill(child, SIGKILL);   // before it has a group
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  SPLATLAS_RETURN_IF_ERROR(check_end(status, exceeded, limits, file_read(*page.get(), path)));
  return file;
}

}  // namespace splatlas
