// Server of a page with the native engine to browsers on this machine, and who may talk to it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "format/atlas_reader.h"
#include "format/result.h"
#include "player/render_options.h"
#include "player/web/server/lesson_file.h"

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
  /// The same with a ticket for one use, for the command line of a browser, which all users see.
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

/// An atlas, and the page that plays it.
struct ServedPage {
  std::shared_ptr<const Atlas> atlas;
  std::function<Result<std::string>(const Atlas&)> html;
  RendererOptions renderer;                         ///< of each worker of a page
  std::uint16_t port = 0;                           ///< 0: any that is free
  std::optional<LessonFile> lesson = std::nullopt;  ///< none: lessons are not saved
};

/// A server on 127.0.0.1 behind a Door; docs/web.md has its addresses. A worker has an engine of its own; all
/// read one atlas. A draft ends what the other workers of its page draw. Limits: 64 KiB for a request without
/// its body, 1 MiB for a body, 10 s for a pause, 400 connections, 100 of them without the token. Thread-safe.
class PageServer {
 public:
  /// kFailed with the port and the reason. Errors of Door::create() and of the page.
  [[nodiscard]] static Result<std::unique_ptr<PageServer>> start(ServedPage page);
  /// Ends all pictures, and returns when no thread is left.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// With the token. Secret: whoever has it sees the atlas.
  [[nodiscard]] std::string address() const;
  /// With a ticket in its place, which works once.
  [[nodiscard]] std::string address_with_ticket() const;
  /// True once pages were open, and the last one has been closed for ten seconds.
  [[nodiscard]] bool is_left() const;
  /// Missing part of a damaged atlas in the pictures so far, as one line; empty: none.
  [[nodiscard]] std::string missing() const;

 private:
  PageServer() = default;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
