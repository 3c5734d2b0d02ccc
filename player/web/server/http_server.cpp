#include "player/web/server/http_server.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>

#include <arpa/inet.h>
#include <microhttpd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

constexpr std::size_t kMaxHeadBytes = 65536;  // cookies of many servers at 127.0.0.1
constexpr std::size_t kMaxBodyBytes = std::size_t{1} << 20;
constexpr unsigned kMaxConnections = 400;
constexpr unsigned kPatienceSeconds = 10;
constexpr std::string_view kEvent = ":\n\n";

std::string_view value_of(MHD_Connection* connection, MHD_ValueKind kind, const char* name) {
  const char* const value = MHD_lookup_connection_value(connection, kind, name);
  return value != nullptr ? value : "";
}

using Beat = std::function<bool()>;

ssize_t write_event(void* beat, std::uint64_t /*position*/, char* to, std::size_t room) {
  if (room < kEvent.size() || !(*static_cast<Beat*>(beat))()) return MHD_CONTENT_READER_END_OF_STREAM;
  std::ranges::copy(kEvent, to);
  return static_cast<ssize_t>(kEvent.size());
}

template <typename T>
void destroy(void* object) {
  delete static_cast<T*>(object);
}

/// Owns what is left of the answer.
MHD_Response* response_of(HttpAnswer& answer) {
  if (answer.beat)
    return MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, 64, write_event,
                                             new Beat(std::move(answer.beat)), destroy<Beat>);
  auto* const body = new std::vector<std::byte>(std::move(answer.body));
  return MHD_create_response_from_buffer_with_free_callback_cls(body->size(), body->data(),
                                                                destroy<std::vector<std::byte>>, body);
}

MHD_Result send(MHD_Connection* connection, HttpAnswer answer) {
  MHD_Response* const response = response_of(answer);
  if (response == nullptr) return MHD_NO;
  MHD_add_response_header(response, "Content-Type", answer.type.c_str());
  MHD_add_response_header(response, "Cache-Control", "no-store");
  MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
  for (const auto& [name, value] : answer.headers)
    MHD_add_response_header(response, name.c_str(), value.c_str());
  const MHD_Result queued = MHD_queue_response(connection, answer.status, response);
  MHD_destroy_response(response);
  return queued;
}

/// The first call of a request has its head, those that follow the body in pieces, and the last one nothing.
MHD_Result on_request(void* closure, MHD_Connection* connection, const char* path, const char* method,
                      const char* /*version*/, const char* piece, std::size_t* piece_bytes,
                      void** state) try {
  const auto& handler = *static_cast<const HttpHandler*>(closure);
  const HttpRequest request(connection, method, path);
  auto*& body = reinterpret_cast<std::string*&>(*state);
  if (body == nullptr) {
    if (!handler.admits(request)) return send(connection, {.status = 403});
    body = new std::string;
    return MHD_YES;
  }
  if (*piece_bytes > 0) {
    if (body->size() + *piece_bytes > kMaxBodyBytes) return MHD_NO;
    body->append(piece, std::exchange(*piece_bytes, 0));
    return MHD_YES;
  }
  return send(connection, handler.answer(request, *body));
} catch (const std::exception&) {
  return MHD_NO;
}

void on_end(void* /*closure*/, MHD_Connection* /*connection*/, void** state,
            MHD_RequestTerminationCode /*why*/) {
  delete static_cast<std::string*>(std::exchange(*state, nullptr));
}

}  // namespace

std::string_view HttpRequest::header(const char* name) const {
  return value_of(connection_, MHD_HEADER_KIND, name);
}

std::string_view HttpRequest::argument(const char* name) const {
  return value_of(connection_, MHD_GET_ARGUMENT_KIND, name);
}

std::string_view HttpRequest::cookie(const std::string& name) const {
  return value_of(connection_, MHD_COOKIE_KIND, name.c_str());
}

struct HttpServer::Daemon {
  HttpHandler handler;
  MHD_Daemon* daemon = nullptr;
  ~Daemon() {
    if (daemon != nullptr) MHD_stop_daemon(daemon);
  }
};

Result<HttpServer> HttpServer::start(std::uint16_t port, HttpHandler handler) {
  HttpServer server;
  server.daemon_ = std::shared_ptr<Daemon>(new Daemon{.handler = std::move(handler)});
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  errno = 0;
  MHD_Daemon* const daemon =
      MHD_start_daemon(MHD_USE_THREAD_PER_CONNECTION | MHD_USE_POLL_INTERNAL_THREAD, 0, nullptr, nullptr,
                       on_request, &server.daemon_->handler, MHD_OPTION_SOCK_ADDR,
                       reinterpret_cast<sockaddr*>(&address), MHD_OPTION_NOTIFY_COMPLETED, on_end, nullptr,
                       MHD_OPTION_CONNECTION_MEMORY_LIMIT, kMaxHeadBytes, MHD_OPTION_CONNECTION_LIMIT,
                       kMaxConnections, MHD_OPTION_CONNECTION_TIMEOUT, kPatienceSeconds, MHD_OPTION_END);
  if (daemon == nullptr)
    return fail(ErrorCode::kFailed, "port {} of 127.0.0.1: cannot be taken: {}; give another --port, or none",
                port, std::strerror(errno));
  server.daemon_->daemon = daemon;
  return server;
}

std::uint16_t HttpServer::port() const {
  return MHD_get_daemon_info(daemon_->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

}  // namespace splatlas
