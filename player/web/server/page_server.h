// Serves a page with the native engine to browsers on this machine.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "format/atlas_reader.h"
#include "player/render_options.h"

namespace splatlas {

/// An atlas, and the page that plays it.
struct ServedPage {
  std::shared_ptr<const Atlas> atlas;
  std::string html;
  RendererOptions renderer;  ///< of each worker of a page
  std::uint16_t port = 0;    ///< 0: any that is free
};

/// A server on 127.0.0.1 behind a Door:
///
///   - GET /: the page.
///   - GET /alive?page=ID: a stream; the page is open as long as it is.
///   - POST /call?page=ID&worker=N: a request to the PageEngine of a worker, 0 or 1. Two numbers of 32 bits,
///     the status and the bytes of the text; the text; and the pixels of a picture, 8-bit sRGB. 410 once the
///     page is closed.
///
/// A worker has an engine of its own; all read one atlas. A draft ends what the other workers of its page
/// draw. Limits: 64 KiB for a request without its body, 1 MiB for a body, 10 s for a pause, 400 connections.
/// Thread-safe.
class PageServer {
 public:
  /// kFailed with the port and the reason. Errors of Door::create().
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
