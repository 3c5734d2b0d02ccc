// Who may talk to the server of a page: its own page alone.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "format/result.h"

namespace splatlas {

/// Credentials of a request.
struct Knock {
  std::string_view host;    ///< header Host
  std::string_view origin;  ///< header Origin; empty: none
  std::string_view token;   ///< of the address; empty: none
  std::string_view cookie;  ///< of the door's name; empty: none
};

/// The door of a server on 127.0.0.1: a random token in the address, and later in a cookie. Thread-safe.
class Door {
 public:
  /// Draws a token of 128 bits. kFailed if the system has no random numbers.
  [[nodiscard]] static Result<Door> create();

  /// True if the token, the unused ticket or the cookie is right, the host is this machine by its loopback
  /// address or name, and the origin, if given, is that host. The port may be another: that of a tunnel.
  [[nodiscard]] bool admits(const Knock& knock) const;

  /// http://127.0.0.1:PORT/?token=TOKEN
  [[nodiscard]] std::string address(std::uint16_t port) const;
  /// The same with a ticket that opens the door once, for the command line of a browser, which all users of
  /// the machine see.
  [[nodiscard]] std::string address_with_ticket(std::uint16_t port) const;
  /// Random: a host has one set of cookies for all its ports.
  [[nodiscard]] const std::string& cookie_name() const { return cookie_name_; }
  /// The header Set-Cookie.
  [[nodiscard]] std::string cookie() const;

 private:
  Door(std::string token, std::string ticket, std::string cookie_name)
      : token_(std::move(token)), ticket_(std::move(ticket)), cookie_name_(std::move(cookie_name)) {}

  std::string token_, ticket_, cookie_name_;
  std::shared_ptr<std::atomic<bool>> is_ticket_valid_ = std::make_shared<std::atomic<bool>>(true);
};

}  // namespace splatlas
