// Unprivileged user for permission tests, which may run as root.
#pragma once

#include <cstdlib>
#include <stdexcept>

#include <unistd.h>

namespace splatlas {

/// Root acts as "nobody" during its lifetime. Other users stay as they are.
class OrdinaryUser {
 public:
  static constexpr uid_t kNobody = 65534;

  OrdinaryUser() {
    if (user_ == 0 && (::setegid(kNobody) != 0 || ::seteuid(kNobody) != 0))
      throw std::runtime_error("cannot become another user");
  }
  ~OrdinaryUser() {
    if (::seteuid(user_) != 0 || ::setegid(group_) != 0) std::abort();
  }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;

 private:
  uid_t user_ = ::geteuid();
  gid_t group_ = ::getegid();
};

/// Gives a file or folder to the user of OrdinaryUser. Returns success.
[[nodiscard]] inline bool give_to_ordinary_user(const char* path) {
  return ::geteuid() != 0 || ::chown(path, OrdinaryUser::kNobody, static_cast<gid_t>(-1)) == 0;
}

}  // namespace splatlas
