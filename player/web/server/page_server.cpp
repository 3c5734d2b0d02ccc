#include "player/web/server/page_server.h"

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "format/result_macros.h"
#include "player/web/page_engine.h"
#include "player/web/server/door.h"
#include "player/web/server/http_server.h"

namespace splatlas {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::chrono::seconds kBeat{1};
constexpr std::chrono::seconds kLeftAfter{10};
constexpr std::uint32_t kNoPage = 410;

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

HttpAnswer answer_of(const PageAnswer& answer, const Picture& picture) {
  const std::array<std::uint32_t, 2> head{static_cast<std::uint32_t>(answer.status),
                                          static_cast<std::uint32_t>(answer.text.size())};
  const std::size_t pixels = sizeof head + answer.text.size();
  std::vector<std::byte> body(pixels + (answer.has_picture ? picture.rgba.size() : 0));
  std::memcpy(body.data(), head.data(), sizeof head);
  std::memcpy(body.data() + sizeof head, answer.text.data(), answer.text.size());
  auto* const to = reinterpret_cast<std::uint8_t*>(body.data() + pixels);
  if (answer.has_picture && !to_srgba8(picture, std::span(to, picture.rgba.size()))) return {.status = 500};
  return {.type = "application/octet-stream", .body = std::move(body)};
}

bool is_draft(const std::string& request) {
  const Json json = Json::parse(request, nullptr, false);
  return json.is_object() && json.value("call", Json()) == "draw" && json.value("quality", Json()) == "draft";
}

}  // namespace

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
  Door door;
  mutable std::mutex mutex;
  std::condition_variable ends;
  bool is_ending = false;
  std::map<std::string, Sessions> open;  // pages by their id
  std::optional<Clock::time_point> left;
  std::string missing;
  std::optional<HttpServer> server;  // last: its threads use the rest

  Impl(ServedPage given, Door opened) : page(std::move(given)), door(std::move(opened)) {}
  ~Impl() {
    {
      const std::scoped_lock lock(mutex);
      is_ending = true;
      for (const auto& [id, sessions] : open) stop_all(sessions);
    }
    ends.notify_all();
    server.reset();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Ends the pictures of sessions, except one's.
  static void stop_all(const Sessions& sessions, const Session* except = nullptr) {
    for (const auto& [worker, session] : sessions) {
      if (session.get() != except) session->stop.request_stop();
    }
  }

  bool admits(const HttpRequest& request) const {
    return door.admits({.host = request.header("Host"),
                        .origin = request.header("Origin"),
                        .token = request.argument("token"),
                        .cookie = request.cookie(door.cookie_name())});
  }

  HttpAnswer answer(const HttpRequest& request, const std::string& body) {
    const std::string id(request.argument("page"));
    if (request.method == "GET" && request.path == "/") return whole_page();
    if (request.method == "GET" && request.path == "/alive" && !id.empty()) return alive(id);
    if (request.method == "POST" && request.path == "/call")
      return call(id, std::string(request.argument("worker")), body);
    return {.status = 404, .body = bytes_of("no such address\n")};
  }

  HttpAnswer whole_page() const {
    return {.type = "text/html; charset=utf-8",
            .body = bytes_of(page.html),
            .headers = {{"Set-Cookie", door.cookie()},
                        {"Referrer-Policy", "no-referrer"},
                        {"Cross-Origin-Resource-Policy", "same-origin"},
                        {"X-Frame-Options", "DENY"}}};
  }

  /// A page is open as long as its stream: until the stream is destroyed.
  HttpAnswer alive(const std::string& id) {
    {
      const std::scoped_lock lock(mutex);
      if (!open.emplace(id, Sessions{}).second)
        return {.status = 409, .body = bytes_of("the page is open\n")};
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
    if (open.empty()) left = Clock::now();
  }

  HttpAnswer call(const std::string& id, const std::string& worker, const std::string& request) {
    const bool ends_others = is_draft(request);
    std::shared_ptr<Session> session;
    {
      const std::scoped_lock lock(mutex);
      const auto found = open.find(id);
      if (found == open.end() || (worker != "0" && worker != "1"))
        return {.status = kNoPage, .body = bytes_of("the page is closed\n")};
      Sessions& sessions = found->second;
      if (!sessions.contains(worker)) {
        auto made = std::make_shared<Session>(page.renderer);
        made->engine.open(page.atlas);
        sessions.emplace(worker, std::move(made));
      }
      session = sessions.at(worker);
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
    note_missing(session->engine.frame());
    return answer_of(answer, session->engine.frame().picture);
  }

  void note_missing(const Frame& frame) {
    if (frame.missing.empty()) return;
    const std::scoped_lock lock(mutex);
    missing = describe(frame.missing.front(), page.atlas->graph());
  }
};

Result<std::unique_ptr<PageServer>> PageServer::start(ServedPage page) {
  SPLATLAS_ASSIGN_OR_RETURN(Door door, Door::create());
  std::unique_ptr<PageServer> made(new PageServer);
  made->impl_ = std::make_unique<Impl>(std::move(page), std::move(door));
  Impl& impl = *made->impl_;
  HttpHandler handler{.admits = [&impl](const HttpRequest& request) { return impl.admits(request); },
                      .answer = [&impl](const HttpRequest& request,
                                        const std::string& body) { return impl.answer(request, body); }};
  SPLATLAS_ASSIGN_OR_RETURN(impl.server, HttpServer::start(impl.page.port, std::move(handler)));
  return made;
}

PageServer::~PageServer() = default;

std::string PageServer::address() const {
  return impl_->door.address(impl_->server->port());
}

std::string PageServer::address_with_ticket() const {
  return impl_->door.address_with_ticket(impl_->server->port());
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
