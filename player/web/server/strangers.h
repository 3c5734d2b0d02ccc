// Connections that have not shown the token.
#pragma once

#include <deque>
#include <mutex>

#include <microhttpd.h>
#include <sys/socket.h>

namespace splatlas {

/// Of more than kMost, the oldest is shut down: those that send slowly leave room for the page. Thread-safe.
class Strangers {
 public:
  /// For MHD_OPTION_NOTIFY_CONNECTION, with a Strangers. A socket is removed before it is closed.
  static void notify(void* closure, MHD_Connection* connection, void** /*context*/,
                     MHD_ConnectionNotificationCode code) {
    auto& strangers = *static_cast<Strangers*>(closure);
    if (code == MHD_CONNECTION_NOTIFY_CLOSED) return strangers.remove(connection);
    const std::scoped_lock lock(strangers.mutex_);
    strangers.sockets_.push_back(socket_of(connection));
    if (std::ssize(strangers.sockets_) <= kMost) return;
    shutdown(strangers.sockets_.front(), SHUT_RDWR);
    strangers.sockets_.pop_front();
  }

  void remove(MHD_Connection* connection) {
    const std::scoped_lock lock(mutex_);
    std::erase(sockets_, socket_of(connection));
  }

 private:
  static MHD_socket socket_of(MHD_Connection* connection) {
    return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
  }

  static constexpr int kMost = 100;
  std::mutex mutex_;
  std::deque<MHD_socket> sockets_;
};

}  // namespace splatlas
