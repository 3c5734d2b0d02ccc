#include "tests/campaigns/faults/run_with_fault.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include <linux/filter.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace splatlas {
namespace {

/// Message that passes a descriptor through a socket pair.
union OneDescriptor {
  cmsghdr header;
  std::array<char, CMSG_SPACE(sizeof(int))> space;
};

msghdr message_with(OneDescriptor& control, iovec& byte) {
  msghdr message{};
  message.msg_iov = &byte;
  message.msg_iovlen = 1;
  message.msg_control = control.space.data();
  message.msg_controllen = control.space.size();
  return message;
}

void send_descriptor(int socket, int descriptor) {
  char byte = 0;
  iovec one{&byte, 1};
  OneDescriptor control{};
  msghdr message = message_with(control, one);
  control.header = {CMSG_LEN(sizeof(int)), SOL_SOCKET, SCM_RIGHTS};
  std::memcpy(CMSG_DATA(&control.header), &descriptor, sizeof descriptor);
  if (::sendmsg(socket, &message, 0) != 1) ::_exit(126);
}

int receive_descriptor(int socket) {
  char byte = 0;
  iovec one{&byte, 1};
  OneDescriptor control{};
  msghdr message = message_with(control, one);
  ssize_t received = -1;
  do {
    received = ::recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
  } while (received < 0 && errno == EINTR);
  if (received != 1 || message.msg_controllen == 0)
    throw std::runtime_error("this system has no seccomp notification");
  int descriptor = -1;
  std::memcpy(&descriptor, CMSG_DATA(&control.header), sizeof descriptor);
  return descriptor;
}

/// For the traced process: from now on it stops at every call of file_call_numbers().
int watch_this_process() {
  std::vector<sock_filter> filter;
  filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
  for (const int number : file_call_numbers()) {
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(number), 0, 1));
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF));
  }
  filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) ::_exit(126);
  const long listener =
      ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &program);
  if (listener < 0) ::_exit(126);
  return static_cast<int>(listener);
}

/// The first half of the memory that a call reads or writes, in the traced process.
std::vector<iovec> first_half(const seccomp_notif& request, const FileCall& call) {
  const auto pid = static_cast<pid_t>(request.pid);
  void* const memory = reinterpret_cast<void*>(request.data.args[1]);
  std::vector<iovec> parts{{memory, request.data.args[2]}};
  if (call.has_vectors) {
    parts.resize(std::min<std::size_t>(request.data.args[2], IOV_MAX));
    iovec here{parts.data(), parts.size() * sizeof(iovec)}, there{memory, here.iov_len};
    if (::process_vm_readv(pid, &here, 1, &there, 1, 0) != static_cast<ssize_t>(here.iov_len)) return {};
  }
  std::size_t left = 0;
  for (const iovec& part : parts) left += part.iov_len;
  left /= 2;
  for (iovec& part : parts) {
    part.iov_len = std::min(part.iov_len, left);
    left -= part.iov_len;
  }
  return parts;
}

/// Copies between `bytes` and parts of another process's memory. Returns the number of bytes, or -1.
using CopyMemory = decltype(&::process_vm_readv);
ssize_t copy(CopyMemory copy_memory, pid_t pid, std::span<std::byte> bytes, const std::vector<iovec>& parts) {
  iovec here{bytes.data(), bytes.size()};
  return copy_memory(pid, &here, 1, parts.data(), parts.size(), 0);
}

/// Does half of a read or write on behalf of another process. Returns its result.
seccomp_notif_resp transfer_half(const seccomp_notif& request, const FileCall& call, int process) {
  const auto descriptor =
      static_cast<int>(::syscall(SYS_pidfd_getfd, process, static_cast<int>(request.data.args[0]), 0));
  const std::vector<iovec> parts = first_half(request, call);
  std::size_t half = 0;
  for (const iovec& part : parts) half += part.iov_len;
  std::vector<std::byte> bytes(half);
  const auto position = static_cast<off_t>(request.data.args[3]);
  const auto pid = static_cast<pid_t>(request.pid);
  const bool is_at_position = call.has_position && position >= 0;  // preadv2() has -1 for the file's own
  ssize_t done = -1;
  if (call.effect == FileCall::Effect::kReads) {
    done = is_at_position ? ::pread(descriptor, bytes.data(), bytes.size(), position)
                          : ::read(descriptor, bytes.data(), bytes.size());
    const auto got = std::span(bytes).first(static_cast<std::size_t>(std::max<ssize_t>(done, 0)));
    if (done > 0 && copy(&::process_vm_writev, pid, got, parts) != done) done = -1;
  } else if (copy(&::process_vm_readv, pid, bytes, parts) == static_cast<ssize_t>(bytes.size())) {
    done = is_at_position ? ::pwrite(descriptor, bytes.data(), bytes.size(), position)
                          : ::write(descriptor, bytes.data(), bytes.size());
  }
  const int reason = errno;
  ::close(descriptor);
  return {request.id, done, done < 0 ? -reason : 0, 0};
}

/// Answers the calls of one process until it ends.
class Supervisor {
 public:
  Supervisor(int listener, pid_t child, const std::filesystem::path& folder, Naming naming,
             std::size_t number, const Fault& fault)
      : listener_(listener),
        child_(child),
        process_(static_cast<int>(::syscall(SYS_pidfd_open, child, 0))),
        folder_(folder),
        naming_(naming),
        number_(number),
        fault_(fault) {}
  ~Supervisor() {
    ::close(process_);
    ::close(listener_);
  }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  void run() {
    for (;;) {
      pollfd waiting{listener_, POLLIN, 0};
      if (::poll(&waiting, 1, -1) < 0) {
        if (errno == EINTR) continue;  // `revents` is not set
        break;
      }
      if ((waiting.revents & POLLIN) == 0) break;
      seccomp_notif request{};
      if (::ioctl(listener_, SECCOMP_IOCTL_NOTIF_RECV, &request) != 0)
        continue;  // interrupted, or the process was killed meanwhile
      seccomp_notif_resp answer = answer_to(request);
      while (::ioctl(listener_, SECCOMP_IOCTL_NOTIF_SEND, &answer) != 0 && errno == EINTR) {
      }
    }
  }

  std::vector<FileCall> calls, outside;

 private:
  [[nodiscard]] seccomp_notif_resp answer_to(const seccomp_notif& request) {
    const seccomp_notif_resp go_on{request.id, 0, 0, SECCOMP_USER_NOTIF_FLAG_CONTINUE};
    const std::optional<FileCall> call = file_call_of(request, folder_);
    if (!call) return go_on;
    if (!is_in(call->path, folder_)) {
      if (call->use != FileCall::NameUse::kNone) outside.push_back(*call);
      return go_on;
    }
    calls.push_back(*call);
    if (call->is_unnamed_file && naming_ == Naming::kNamed) return {request.id, 0, -EOPNOTSUPP, 0};
    const std::size_t n = calls.size() - 1;
    if (n == number_) {
      struck_ = *call;
      return strike(request, *call, fault_.kind);
    }
    if (n > number_ && fault_.lasts && is_struck_too(*call))
      return strike(request, *call, Fault::Kind::kError);
    return go_on;
  }

  [[nodiscard]] bool is_struck_too(const FileCall& call) const {
    using Effect = FileCall::Effect;
    if (fault_.error == ENOSPC) return call.effect == Effect::kStores;
    return (call.effect == Effect::kReads) == (struck_.effect == Effect::kReads);
  }

  [[nodiscard]] seccomp_notif_resp strike(const seccomp_notif& request, const FileCall& call,
                                          Fault::Kind kind) const {
    seccomp_notif_resp answer{request.id, 0, -fault_.error, 0};
    if (kind == Fault::Kind::kShort || kind == Fault::Kind::kTear)
      answer = transfer_half(request, call, process_);
    if (kind == Fault::Kind::kKill || kind == Fault::Kind::kTear) ::kill(child_, SIGKILL);
    return answer;
  }

  int listener_;
  pid_t child_;
  int process_;
  const std::filesystem::path& folder_;
  Naming naming_;
  std::size_t number_;
  const Fault& fault_;
  FileCall struck_;
};

}  // namespace

FaultyRun run_with_fault(const std::vector<std::string>& words, const std::filesystem::path& folder,
                         Naming naming, std::size_t number, const Fault& fault) {
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, sockets.data()) != 0)
    throw std::runtime_error("cannot make a socket pair");
  const timeval patience{10, 0};  // timeout, for systems that refuse the filter
  ::setsockopt(sockets[0], SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  FaultyRun run;
  const auto supervise = [&](int child) {
    Supervisor supervisor(receive_descriptor(sockets[0]), child, folder, naming, number, fault);
    supervisor.run();
    run.calls = std::move(supervisor.calls);
    run.outside = std::move(supervisor.outside);
  };
  const auto watch = [&] { send_descriptor(sockets[1], watch_this_process()); };
  run.result = run_program(words, folder, supervise, watch);
  for (const int socket : sockets) ::close(socket);
  return run;
}

}  // namespace splatlas
