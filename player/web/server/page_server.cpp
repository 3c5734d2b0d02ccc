#include "player/web/server/page_server.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <map>
#include <mutex>
#include <stop_token>
#include <vector>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <microhttpd.h>
#include <nettle/memops.h>
#include <nlohmann/json.hpp>
#include <sys/random.h>
#include <sys/socket.h>

#include "format/result_macros.h"
#include "format/text/json_text.h"
#include "player/web/page_engine.h"
#include "player/web/server/call_answer.h"
#include "player/web/server/strangers.h"

namespace splatlas {
namespace {

constexpr const char* kAddress = "http://127.0.0.1:{}/?token={}";

/// Takes the same time for all texts of this length.
bool is_same(std::string_view text, std::string_view secret) {
  return text.size() == secret.size() && memeql_sec(text.data(), secret.data(), secret.size()) != 0;
}

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;
constexpr std::chrono::seconds kBeat{1};
constexpr std::chrono::seconds kLeftAfter{10};
constexpr std::uint32_t kNoPage = 410;
constexpr std::size_t kMaxHeadBytes = 65536;  // cookies of many servers at 127.0.0.1
constexpr std::size_t kMaxBodyBytes = std::size_t{1} << 20;
constexpr unsigned kMaxConnections = 400;
constexpr unsigned kPatienceSeconds = 10;
constexpr std::string_view kEvent = ":\n\n";

struct HttpRequest {
  MHD_Connection* connection;
  std::string_view method, path;

  /// Of the address, decoded, or of the head, as it was sent; empty: none.
  [[nodiscard]] std::string_view value(MHD_ValueKind kind, const char* name) const {
    const char* const value = MHD_lookup_connection_value(connection, kind, name);
    return value != nullptr ? value : "";
  }
  [[nodiscard]] std::string argument(const char* name) const {
    return std::string(value(MHD_GET_ARGUMENT_KIND, name));
  }
};

using Beat = std::function<bool()>;
struct HttpAnswer {
  unsigned status = 200;
  const char* type = "text/plain";
  std::string body = {};
  std::vector<std::pair<const char*, std::string>> headers = {};
  /// If set, the answer is a stream of events without content: beat() waits for the time of the next one, and
  /// returns false at the end. Destroyed once the client has closed the connection.
  Beat beat = {};
};

ssize_t write_event(void* beat, std::uint64_t /*position*/, char* to, std::size_t room) {
  if (room < kEvent.size() || !(*static_cast<Beat*>(beat))()) return MHD_CONTENT_READER_END_OF_STREAM;
  std::ranges::copy(kEvent, to);
  return static_cast<ssize_t>(kEvent.size());
}

template <typename T>
void destroy(void* object) {
  delete static_cast<T*>(object);
}

MHD_Response* response_of(HttpAnswer& answer) {
  if (answer.beat)
    return MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, 64, write_event,
                                             new Beat(std::move(answer.beat)), destroy<Beat>);
  auto* const body = new std::string(std::move(answer.body));
  return MHD_create_response_from_buffer_with_free_callback_cls(body->size(), body->data(),
                                                                destroy<std::string>, body);
}

MHD_Result send(MHD_Connection* connection, HttpAnswer answer) {
  MHD_Response* const response = response_of(answer);
  if (response == nullptr) return MHD_NO;
  MHD_add_response_header(response, "Content-Type", answer.type);
  MHD_add_response_header(response, "Cache-Control", "no-store");
  MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
  for (const auto& [name, value] : answer.headers) MHD_add_response_header(response, name, value.c_str());
  const MHD_Result queued = MHD_queue_response(connection, answer.status, response);
  MHD_destroy_response(response);
  return queued;
}

void on_end(void* /*closure*/, MHD_Connection* /*connection*/, void** state,
            MHD_RequestTerminationCode /*why*/) {
  delete static_cast<std::string*>(std::exchange(*state, nullptr));
}

HttpAnswer said(const char* what, const std::string& text) {
  return {.type = "application/json", .body = json_text(Json::array({what, text}), -1)};
}

}  // namespace

Result<Door> Door::create() {
  std::array<std::uint8_t, 40> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return fail(ErrorCode::kFailed, "no random numbers: {}", std::strerror(errno));
  const std::string digits = fmt::format("{:02x}", fmt::join(bytes, ""));
  return Door(digits.substr(0, 32), digits.substr(32, 32), "splatlas-" + digits.substr(64));
}

bool Door::admits(const Knock& knock) const {
  const std::string_view name = knock.host.substr(0, knock.host.find(':'));
  const std::string_view port = knock.host.substr(std::min(name.size() + 1, knock.host.size()));
  const bool is_here = (name == "127.0.0.1" || name == "localhost") &&
                       std::ranges::all_of(port, [](char c) { return c >= '0' && c <= '9'; });
  const bool is_own = knock.origin.empty() || knock.origin == fmt::format("http://{}", knock.host);
  if (!is_here || !is_own) return false;
  return is_same(knock.token, token_) || is_same(knock.cookie, token_) ||
         (is_same(knock.token, ticket_) && is_ticket_valid_->exchange(false));
}

std::string Door::address(std::uint16_t port) const {
  return fmt::format(kAddress, port, token_);
}

std::string Door::address_with_ticket(std::uint16_t port) const {
  return fmt::format(kAddress, port, ticket_);
}

std::string Door::cookie() const {
  return fmt::format("{}={}; Path=/; Max-Age=86400; HttpOnly; SameSite=Strict", cookie_name_, token_);
}

struct PageServer::Impl {
  /// The engine of a worker.
  struct Session {
    explicit Session(const RendererOptions& options) : engine(options) {}
    std::mutex busy;
    PageEngine engine;
    std::stop_source stop;  // of the picture under way; of the server's mutex
  };

  /// The workers of an open page, by number.
  using Sessions = std::map<std::string, std::shared_ptr<Session>>;

  ServedPage page;
  std::string html;
  Door door;
  std::mutex saving;  // before the other
  mutable std::mutex mutex;
  std::condition_variable ends;
  bool is_ending = false;
  std::map<std::string, Sessions> open;  // pages by their id
  std::optional<Clock::time_point> left;
  std::string missing;
  Strangers strangers;
  MHD_Daemon* daemon = nullptr;

  Impl(ServedPage given, std::string encoded, Door opened)
      : page(std::move(given)), html(std::move(encoded)), door(std::move(opened)) {}
  ~Impl() {
    {
      const std::scoped_lock lock(mutex);
      is_ending = true;
      for (const auto& [id, sessions] : open) stop_all(sessions);
    }
    ends.notify_all();
    if (daemon != nullptr) MHD_stop_daemon(daemon);  // its threads use the rest
  }

  /// Ends the pictures of sessions, except one's.
  static void stop_all(const Sessions& sessions, const Session* except = nullptr) {
    for (const auto& [worker, session] : sessions) {
      if (session.get() != except) session->stop.request_stop();
    }
  }

  /// Answers each connection on a thread of its own.
  Result<void> serve() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(page.port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    errno = 0;
    daemon = MHD_start_daemon(
        MHD_USE_THREAD_PER_CONNECTION | MHD_USE_POLL_INTERNAL_THREAD, 0, nullptr, nullptr, on_request, this,
        MHD_OPTION_SOCK_ADDR, reinterpret_cast<sockaddr*>(&address), MHD_OPTION_NOTIFY_COMPLETED, on_end,
        nullptr, MHD_OPTION_NOTIFY_CONNECTION, Strangers::notify, &strangers,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, kMaxHeadBytes, MHD_OPTION_CONNECTION_LIMIT, kMaxConnections,
        MHD_OPTION_CONNECTION_TIMEOUT, kPatienceSeconds, MHD_OPTION_END);
    if (daemon != nullptr) return {};
    return fail(ErrorCode::kFailed, "port {} of 127.0.0.1: cannot be taken: {}; give another --port, or none",
                page.port, std::strerror(errno));
  }

  [[nodiscard]] auto port() const { return MHD_get_daemon_info(daemon, MHD_DAEMON_INFO_BIND_PORT)->port; }

  /// The first call of a request has its head, those that follow pieces of the body, the last one nothing.
  static MHD_Result on_request(void* closure, MHD_Connection* connection, const char* path,
                               const char* method, const char* /*version*/, const char* piece,
                               std::size_t* piece_bytes, void** state) try {
    auto& impl = *static_cast<Impl*>(closure);
    const HttpRequest request{connection, method, path};
    auto*& body = reinterpret_cast<std::string*&>(*state);
    if (body == nullptr) {
      if (!impl.admits(request)) return send(connection, {.status = 403});
      impl.strangers.remove(connection);
      body = new std::string;
      return MHD_YES;
    }
    if (*piece_bytes > 0) {
      if (body->size() + *piece_bytes > kMaxBodyBytes) return MHD_NO;
      body->append(piece, std::exchange(*piece_bytes, 0));
      return MHD_YES;
    }
    return send(connection, impl.answer(request, *body));
  } catch (const std::exception&) {
    return MHD_NO;
  }

  /// Without: 403, before the body is read.
  bool admits(const HttpRequest& request) const {
    return door.admits({.host = request.value(MHD_HEADER_KIND, "Host"),
                        .origin = request.value(MHD_HEADER_KIND, "Origin"),
                        .token = request.value(MHD_GET_ARGUMENT_KIND, "token"),
                        .cookie = request.value(MHD_COOKIE_KIND, door.cookie_name().c_str())});
  }

  HttpAnswer answer(const HttpRequest& request, const std::string& body) {
    const std::string id = request.argument("page");
    if (request.method == "GET" && request.path == "/") return whole_page();
    if (request.method == "GET" && request.path == "/alive" && !id.empty()) return alive(id);
    if (request.method == "POST" && request.path == "/call")
      return call(id, request.argument("worker"), body);
    if (request.method == "POST" && request.path == "/lesson")
      return save(id, body, !request.argument("replaces").empty());
    return {.status = 404, .body = "no such address\n"};
  }

  HttpAnswer whole_page() const {
    const std::scoped_lock lock(mutex);
    return {.type = "text/html; charset=utf-8",
            .body = html,
            .headers = {{"Set-Cookie", door.cookie()},
                        {"Referrer-Policy", "no-referrer"},
                        {"Cross-Origin-Resource-Policy", "same-origin"},
                        {"X-Frame-Options", "DENY"}}};
  }

  /// A page is open as long as its stream: until the stream is destroyed.
  HttpAnswer alive(const std::string& id) {
    {
      const std::scoped_lock lock(mutex);
      if (!open.emplace(id, Sessions{}).second) return {.status = 409, .body = "the page is open\n"};
      left.reset();
    }
    const std::shared_ptr<const void> guard(nullptr, [this, id](const void*) { close(id); });
    return {.type = "text/event-stream", .beat = [this, guard] {
              std::unique_lock lock(mutex);
              return !ends.wait_for(lock, kBeat, [this] { return is_ending; });
            }};
  }

  void close(const std::string& id) {
    const std::scoped_lock lock(mutex);
    stop_all(open.at(id));
    open.erase(id);
    malloc_trim(0);
    if (open.empty()) left = Clock::now();
  }

  HttpAnswer call(const std::string& id, const std::string& worker, const std::string& request) {
    const Json asked = Json::parse(request, nullptr, false);
    const bool ends_others = asked.is_object() && asked.value("call", Json()) == "draw" &&
                             asked.value("quality", Json()) == "draft";
    std::shared_ptr<Session> session;
    Sessions of_page;
    {
      const std::scoped_lock lock(mutex);
      const auto found = open.find(id);
      if (found == open.end() || (worker != "0" && worker != "1"))
        return {.status = kNoPage, .body = "the page is closed\n"};
      Sessions& sessions = found->second;
      if (!sessions.contains(worker)) {
        auto made = std::make_shared<Session>(page.renderer);
        made->engine.open(page.atlas);
        sessions.emplace(worker, std::move(made));
      }
      session = sessions.at(worker);
      of_page = sessions;
      if (ends_others) stop_all(sessions, session.get());
    }
    const std::scoped_lock one(session->busy);
    std::stop_token stop;
    {
      const std::scoped_lock lock(mutex);
      if (is_ending || !open.contains(id)) return {.status = kNoPage};
      session->stop = std::stop_source();
      stop = session->stop.get_token();
    }
    const PageAnswer answer = session->engine.call(request, {}, {.stop = stop});
    if (const Frame& frame = session->engine.frame(); !frame.missing.empty()) {
      const std::scoped_lock lock(mutex);
      missing = describe(frame.missing.front(), page.atlas->graph());
    }
    if (answer.has_picture && !ends_others) {
      for (const auto& [number, each] : of_page) {
        std::unique_lock idle(each->busy, std::defer_lock);
        if (each == session || idle.try_lock()) each->engine.rest();
      }
      malloc_trim(0);  // what decoding left, on all threads
    }
    return {.type = "application/octet-stream", .body = call_answer(answer, session->engine.frame().picture)};
  }

  HttpAnswer save(const std::string& id, const std::string& scenes, bool replaces) {
    const std::scoped_lock one(saving);
    {
      const std::scoped_lock lock(mutex);
      if (!page.lesson || !open.contains(id)) return {.status = kNoPage};
    }
    const auto saved = page.lesson->save(*page.atlas, id, scenes, replaces);
    if (!saved) return said("refused", saved.error().message);
    if (!saved->atlas) return said("asks", saved->text);
    auto encoded = page.html(*saved->atlas);
    const std::scoped_lock lock(mutex);
    page.atlas = saved->atlas;
    if (encoded) html = *std::move(encoded);
    return said("saved", saved->text);
  }
};

Result<std::unique_ptr<PageServer>> PageServer::start(ServedPage page) {
  SPLATLAS_ASSIGN_OR_RETURN(Door door, Door::create());
  std::unique_ptr<PageServer> made(new PageServer);
  SPLATLAS_ASSIGN_OR_RETURN(std::string html, page.html(*page.atlas));
  made->impl_ = std::make_unique<Impl>(std::move(page), std::move(html), std::move(door));
  SPLATLAS_RETURN_IF_ERROR(made->impl_->serve());
  return made;
}

PageServer::~PageServer() = default;

std::string PageServer::address() const {
  return impl_->door.address(impl_->port());
}

std::string PageServer::address_with_ticket() const {
  return impl_->door.address_with_ticket(impl_->port());
}

bool PageServer::is_left() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->left && Clock::now() - *impl_->left > kLeftAfter;
}

std::string PageServer::missing() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->missing;
}

}  // namespace splatlas
