// A server of HTTP on the loopback address, by GNU libmicrohttpd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/result.h"

struct MHD_Connection;

namespace splatlas {

/// A request, while it is answered. Texts are as they were sent; missing ones are empty.
class HttpRequest {
 public:
  HttpRequest(MHD_Connection* connection, std::string_view method, std::string_view path)
      : method(method), path(path), connection_(connection) {}
  const std::string_view method, path;
  [[nodiscard]] std::string_view header(const char* name) const;
  [[nodiscard]] std::string_view argument(const char* name) const;  ///< of the address, decoded
  [[nodiscard]] std::string_view cookie(const std::string& name) const;

 private:
  MHD_Connection* connection_;
};

/// An answer.
struct HttpAnswer {
  unsigned status = 200;
  std::string type = "text/plain";  ///< media type
  std::vector<std::byte> body = {};
  std::vector<std::pair<std::string, std::string>> headers = {};
  /// If set, the answer is a stream of events without content: beat() waits for the time of the next one, and
  /// returns false at the end. Destroyed once the client has closed the connection.
  std::function<bool()> beat = {};
};

/// Callbacks of a server, on any thread.
struct HttpHandler {
  /// False: 403, before the body is read.
  std::function<bool(const HttpRequest&)> admits;
  std::function<HttpAnswer(const HttpRequest&, const std::string& body)> answer;
};

/// Answers each connection on a thread of its own. Limits: 64 KiB for a request without its body, 1 MiB for a
/// body, 10 s for a pause, 400 connections.
class HttpServer {
 public:
  /// Serves at a port of 127.0.0.1 until the server is destroyed, which waits for answers under way; 0: any
  /// port that is free. kFailed with the port and the reason.
  [[nodiscard]] static Result<HttpServer> start(std::uint16_t port, HttpHandler handler);
  [[nodiscard]] std::uint16_t port() const;

 private:
  struct Daemon;
  std::shared_ptr<Daemon> daemon_;
};

}  // namespace splatlas
