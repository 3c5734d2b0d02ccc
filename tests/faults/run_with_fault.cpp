#include "tests/faults/run_with_fault.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <optional>
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
  if (::recvmsg(socket, &message, MSG_CMSG_CLOEXEC) != 1 || message.msg_controllen == 0)
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

/// Does half of a read or write on behalf of another process. Returns its result.
seccomp_notif_resp transfer_half(const seccomp_notif& request, const FileCall& call, int process) {
  const auto descriptor =
      static_cast<int>(::syscall(SYS_pidfd_getfd, process, static_cast<int>(request.data.args[0]), 0));
  std::vector<std::byte> bytes(request.data.args[2] / 2);
  const auto position = static_cast<off_t>(request.data.args[3]);
  const auto pid = static_cast<pid_t>(request.pid);
  iovec here{bytes.data(), bytes.size()};
  iovec there{reinterpret_cast<void*>(request.data.args[1]), bytes.size()};
  ssize_t done = -1;
  if (call.effect == FileCall::Effect::kReads) {
    done = call.has_position ? ::pread(descriptor, bytes.data(), bytes.size(), position)
                             : ::read(descriptor, bytes.data(), bytes.size());
    here.iov_len = there.iov_len = static_cast<std::size_t>(std::max<ssize_t>(done, 0));
    if (done > 0 && ::process_vm_writev(pid, &here, 1, &there, 1, 0) != done) done = -1;
  } else if (::process_vm_readv(pid, &here, 1, &there, 1, 0) == static_cast<ssize_t>(bytes.size())) {
    done = call.has_position ? ::pwrite(descriptor, bytes.data(), bytes.size(), position)
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
    pollfd waiting{listener_, POLLIN, 0};
    while (::poll(&waiting, 1, -1) >= 0 || errno == EINTR) {
      if ((waiting.revents & POLLIN) == 0) break;
      seccomp_notif request{};
      if (::ioctl(listener_, SECCOMP_IOCTL_NOTIF_RECV, &request) != 0)
        continue;  // the process was killed meanwhile
      seccomp_notif_resp answer = answer_to(request);
      ::ioctl(listener_, SECCOMP_IOCTL_NOTIF_SEND, &answer);
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
