// The server of a page: whom it lets in, what it answers, and what ends a picture.
#include "player/web/server/page_server.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <thread>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "format/atlas_writer.h"
#include "player/web/page_engine.h"
#include "tests/format/ordinary_user.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/phantom_content.h"
#include "tests/support/render.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

/// A connection. Reads end after twenty seconds without a byte.
class LoopbackClient {
 public:
  explicit LoopbackClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no connection");
  }
  ~LoopbackClient() { ::close(socket_); }
  LoopbackClient(const LoopbackClient&) = delete;
  LoopbackClient& operator=(const LoopbackClient&) = delete;

  /// Returns false if the server has closed the connection.
  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// All that comes until the server closes the connection, or until it holds `end`.
  std::string receive(std::string_view end = {}) const {
    std::string text, piece(65536, '\0');
    while (end.empty() || text.find(end) == std::string::npos) {
      const ssize_t got = recv(socket_, piece.data(), piece.size(), 0);
      if (got <= 0) break;
      text.append(piece, 0, static_cast<std::size_t>(got));
    }
    return text;
  }

 private:
  int socket_;
};

/// A reply with the connection's end.
struct HttpReply {
  int status = 0;  ///< 0: the connection was closed without a reply
  std::string head, body;
};

HttpReply reply_to(std::uint16_t port, const std::string& request) {
  const LoopbackClient client(port);
  client.send(request);
  const std::string text = client.receive();
  if (text.empty()) return {};
  const std::size_t end = text.find("\r\n\r\n");
  return {std::stoi(text.substr(text.find(' '))), text.substr(0, end), text.substr(end + 4)};
}

/// The page of an atlas.
Result<std::string> page_of(const Atlas& atlas) {
  return fmt::format("<p>{} scenes</p>", atlas.scenes().size());
}

/// An answer of /call.
struct CallReply {
  int http = 0;
  std::uint32_t status = 0;
  std::array<std::uint32_t, 6> head = {};
  std::string text = {}, pixels = {};
};

/// An atlas in a folder, which is played.
class PlayedAtlas : public testing::Test {
 protected:
  static std::shared_ptr<const Atlas> written(const std::string& file) {
    value_or_throw(write_atlas(phantom_content(), file));
    return value_or_throw(Atlas::open(file));
  }
  const TemporaryFolder folder_;
  const std::string file_ = folder_.file("a.atlas");
  std::shared_ptr<const Atlas> atlas_ = written(file_);
};

class PageServerTest : public PlayedAtlas {
 protected:
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::string query(const std::string& more = "") const { return "?token=" + token_ + more; }

  [[nodiscard]] HttpReply get(const std::string& target, const std::string& headers) const {
    return reply_to(port_, fmt::format("GET {} HTTP/1.1\r\nConnection: close\r\n{}\r\n", target, headers));
  }
  [[nodiscard]] std::string own_host() const { return fmt::format("Host: 127.0.0.1:{}\r\n", port_); }

  [[nodiscard]] std::string post(const std::string& target, const std::string& body) const {
    return fmt::format("POST {} HTTP/1.1\r\nConnection: close\r\n{}Content-Length: {}\r\n\r\n{}", target,
                       own_host(), body.size(), body);
  }
  [[nodiscard]] CallReply call(int worker, const std::string& request) const {
    const HttpReply reply = reply_to(
        port_, post(fmt::format("/call{}", query(fmt::format("&page=p&worker={}", worker))), request));
    CallReply answer{.http = reply.status};
    if (reply.status != 200) return answer;
    std::memcpy(answer.head.data(), reply.body.data(), sizeof answer.head);
    answer.status = answer.head[0];
    answer.text = reply.body.substr(24, answer.head[1]);
    answer.pixels = reply.body.substr(24 + answer.head[1]);
    return answer;
  }

  /// Opens page p, which is open as long as the connection.
  [[nodiscard]] std::unique_ptr<LoopbackClient> open_page() const {
    auto page = std::make_unique<LoopbackClient>(port_);
    page->send(fmt::format("GET /alive{} HTTP/1.1\r\n{}\r\n", query("&page=p"), own_host()));
    EXPECT_THAT(page->receive("\r\n\r\n"), HasSubstr("text/event-stream"));
    return page;
  }

  const std::unique_ptr<PageServer> server_ = value_or_throw(PageServer::start(
      {.atlas = atlas_, .html = page_of, .renderer = {.threads = 2}, .lesson = LessonFile(file_, {})}));
  const std::string address_ = server_->address();
  const std::string token_ = address_.substr(address_.find('=') + 1);
  const std::uint16_t port_ = static_cast<std::uint16_t>(std::stoi(address_.substr(address_.rfind(':') + 1)));
};

TEST_F(PageServerTest, AdmitsItsOwnPageAlone) {
  const HttpReply page = get("/" + query(), own_host());
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<p>0 scenes</p>");
  const std::size_t cookie = page.head.find("Set-Cookie: ") + 12;
  const std::string given = page.head.substr(cookie, page.head.find(';', cookie) - cookie);
  EXPECT_EQ(get("/", own_host() + "Cookie: " + given + "\r\n").status, 200);
  EXPECT_EQ(get("/" + query(), fmt::format("Host: localhost:8000\r\n")).status, 200) << "a tunnel";
  EXPECT_EQ(get("/" + query(), own_host() + fmt::format("Origin: http://127.0.0.1:{}\r\n", port())).status,
            200);

  const std::string wrong_token = "?token=" + std::string(token_.size(), '0');
  for (const auto& [target, headers] : {std::pair<std::string, std::string>{"/", own_host()},
                                        {"/" + wrong_token, own_host()},
                                        {"/?token=", own_host()},
                                        {"/nothing", own_host()},
                                        {"/" + query(), "Host: evil.example\r\n"},
                                        {"/" + query(), "Host: 127.0.0.1.evil.example\r\n"},
                                        {"/" + query(), own_host() + "Origin: http://evil.example\r\n"},
                                        {"/" + query(), own_host() + "Origin: http://127.0.0.1:1\r\n"},
                                        {"/" + query(), own_host() + "Origin: null\r\n"},
                                        {"/", own_host() + "Cookie: " + given + "0\r\n"}}) {
    const HttpReply refused = get(target, headers);
    EXPECT_EQ(refused.status, 403) << target << headers;
    EXPECT_EQ(refused.body, "");
  }
  EXPECT_EQ(get("/etc/passwd" + query(), own_host()).status, 404);
}

/// The server stays as it was, whatever is sent without the token, and with it.
TEST_F(PageServerTest, RefusesWhatIsMalformed) {
  const auto page = open_page();
  std::minstd_rand random(5);
  const std::string good = post("/call" + query("&page=p&worker=0"), R"({"call": "wanted"})");
  for (int n = 0; n < 1000; ++n) {
    std::string bytes = n % 2 == 0 ? good : good.substr(0, random() % good.size());
    for (int change = 0; change < 3 && !bytes.empty(); ++change)
      bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
    const LoopbackClient client(port());
    client.send(bytes);
  }
  for (const char* request :
       {"", "[]", "{}", "{\"call\": 3}", R"({"call": "fly"})", R"({"call": "open"})",
        R"({"call": "openRemote", "size": -1})", R"({"call": "give", "offset": 1e300})",
        R"({"call": "draw"})", R"({"call": "draw", "size": [0, 1]})", R"({"call": "draw", "size": [1e9, 1]})",
        R"({"call": "draw", "size": ["1", 1]})",
        R"({"call": "draw", "size": [8, 8], "camera": {"zoom": "x"}})",
        R"({"call": "draw", "size": [8, 8], "quality": "best"})",
        R"({"call": "draw", "size": [8, 8], "camera": {"fit": {"structure": 1e300}}})",
        R"({"call": "draw", "size": [8, 8], "cuts": [{"normal": [0, 0, 0], "offset": 1}]})"}) {
    const CallReply reply = call(0, request);
    EXPECT_EQ(reply.http, 200) << request;
    EXPECT_NE(reply.status, 0U) << request;
    EXPECT_NE(reply.text, "") << request;
  }
  const std::string large(std::size_t{2} << 20, ' ');
  EXPECT_NE(reply_to(port(), post("/call" + query("&page=p&worker=0"), large)).status, 200);
  EXPECT_NE(get("/" + query("&more=" + large), own_host()).status, 200);
  EXPECT_EQ(call(2, R"({"call": "wanted"})").http, 410);
  EXPECT_EQ(get("/" + query(), own_host()).status, 200);
}

TEST_F(PageServerTest, AnswersBesideThoseThatAreSlow) {
  std::vector<std::unique_ptr<LoopbackClient>> slow;
  for (int n = 0; n < 450; ++n) {
    slow.push_back(std::make_unique<LoopbackClient>(port()));
    slow.back()->send("GET / HT");
  }
  EXPECT_EQ(get("/" + query(), own_host()).status, 200);
}

TEST_F(PageServerTest, DrawsThePicturesOfTheRenderer) {
  const auto page = open_page();
  const CallReply drawn = call(
      0,
      R"({"call": "draw", "select": "*:surface", "size": [240, 180], "camera": {"azimuth": 30, "fit": {"zoom": 0.5}}})");
  ASSERT_EQ(drawn.status, 0U) << drawn.text;
  Renderer renderer(atlas_, {.threads = 1});
  value_or_throw(renderer.select(selection_of("*:surface", atlas_->graph())));
  const RenderOptions options{.size = {240, 180}};
  RenderOptions draft = options;
  draft.quality = Quality::kDraft;
  Camera camera = value_or_throw(renderer.fit({.azimuth_deg = 30}, draft));
  camera.zoom *= 0.5;
  const auto expected = to_srgba8(value_or_throw(renderer.render(camera, options)).picture);
  std::string whole(expected.size(), '\0');
  const auto [status, bytes, left, top, width, height] = drawn.head;
  for (std::size_t y = 0; y < height; ++y)
    whole.replace(4 * ((top + y) * 240 + left), 4UL * width, drawn.pixels, 4 * y * width, 4UL * width);
  EXPECT_TRUE(whole == std::string(expected.begin(), expected.end()));
  EXPECT_LT(drawn.pixels.size(), expected.size() / 4) << "the margin is left out";

  const CallReply pick = call(0, R"({"call": "pick", "at": [120, 90]})");
  EXPECT_EQ(pick.status, 0U);
  EXPECT_EQ(pick.pixels, "");
  const Json names = Json::parse(
      call(0, R"({"call": "labels", "glyphs": {"2": 9999}, "dpi": 72, "background": "#ffffff"})").text);
  EXPECT_EQ(names.at("lines").size(), names.at("dots").size()) << "a rule";
  const Json group = Json::parse(
      call(0,
           R"({"call": "labels", "glyphs": {}, "dpi": 36, "background": "#ffffff", "labels": ["Spheres"]})")
          .text);
  ASSERT_EQ(group.at("texts").size(), 1U);
  EXPECT_EQ(group.at("texts")[0][0], "Spheres") << "a group has one label";
  EXPECT_EQ(call(1, R"({"call": "pick", "at": [120, 90]})").text, "null\n")
      << "each worker has a picture of its own";
  EXPECT_EQ(call(1, R"({"call": "draw", "select": "", "size": [9, 9]})").pixels, std::string(4, '\0'));
  EXPECT_EQ(Json::parse(call(0, R"({"call": "info"})").text).at("structures").size(), atlas_->graph().size());
}

TEST_F(PageServerTest, ADraftEndsTheRefinement) {
  const auto page = open_page();
  std::atomic<bool> is_over = false;
  CallReply refined;
  std::thread refinement([&] {
    refined = call(
        1,
        R"({"call": "draw", "select": "*:volume", "size": [8000, 8000], "quality": "high", "camera": {"projection": "perspective", "zoom": 3}})");
    is_over = true;
  });
  while (!is_over) {
    EXPECT_EQ(
        call(0, R"({"call": "draw", "select": "*:surface", "size": [20, 20], "quality": "draft"})").status,
        0U);
  }
  refinement.join();
  EXPECT_EQ(refined.status, 1 + static_cast<std::uint32_t>(ErrorCode::kCancelled)) << refined.text;
}

TEST_F(PageServerTest, APageIsOpenAsLongAsItsStream) {
  EXPECT_EQ(call(0, R"({"call": "wanted"})").http, 410);
  EXPECT_FALSE(server_->is_left());
  auto page = open_page();
  EXPECT_EQ(call(0, R"({"call": "wanted"})").http, 200);
  EXPECT_EQ(get("/alive" + query("&page=p"), own_host()).status, 409);
  page.reset();
  while (call(0, R"({"call": "wanted"})").http == 200) std::this_thread::yield();
  const auto again = open_page();
  EXPECT_EQ(call(0, R"({"call": "wanted"})").http, 200);
}

std::string scene_named(const std::string& name, const std::string& select = "Sphere_1:surface(ghost)",
                        const std::string& cut = "0,-1,0,-15", const std::string& label = "Sphere_2") {
  return fmt::format(
      R"({{"name": "{}", "select": "{}", "question": "Which?", "caption": "One\nTwo", "azimuth": 30, "elevation": -10.5, "zoom": 1.5, "projection": "perspective", "center": "1,2,3.5", "cuts": ["{}", "left=10"], "labels": ["{}"]}})",
      name, select, cut, label);
}

class LessonFileTest : public PlayedAtlas {
 protected:
  [[nodiscard]] SavedLesson save(const std::string& page, const std::string& scenes, bool replaces = false) {
    return value_or_throw(lesson_.save(*atlas_, page, "[" + scenes + "]", replaces));
  }
  LessonFile lesson_{file_, {}};
};

TEST_F(LessonFileTest, GoesIntoTheAtlasAndReplacesNoOtherWithoutAQuestion) {
  const SavedLesson saved = save("p", scene_named("A") + "," + scene_named("B"));
  EXPECT_EQ(saved.text, "The lesson is saved in a.atlas.");
  atlas_ = value_or_throw(Atlas::open(file_));
  const Scene expected{"A",         "One\nTwo", "Sphere_1:surface(ghost)", 30,        -10.5,
                       1.5,         "Which?",   "0,-1,0,-15 left=10",      "1,2,3.5", true,
                       {"Sphere_2"}};
  EXPECT_EQ(atlas_->scenes().at(0), expected);
  EXPECT_EQ(saved.atlas->scenes(), atlas_->scenes());
  EXPECT_EQ(save("p", scene_named("A")).text, saved.text) << "its own lesson";
  const std::string before = read_bytes(file_);
  const SavedLesson question = save("q", scene_named("C"));
  EXPECT_EQ(question.atlas, nullptr);
  EXPECT_EQ(question.text, "Replace the lesson in a.atlas?");
  EXPECT_EQ(read_bytes(file_), before);
  EXPECT_EQ(save("q", scene_named("C"), true).text, saved.text);
  EXPECT_EQ(value_or_throw(Atlas::open(file_))->scenes().at(0).name, "C");
  EXPECT_THAT(folder_.names(), testing::ElementsAre("a.atlas"));
}

TEST_F(LessonFileTest, BadScenesAndChangedAtlasesStayAsTheyAre) {
  const std::string before = read_bytes(file_);
  for (const std::string& bad :
       {std::string("{"), std::string("3"), std::string(R"({"name": "A"})"), scene_named(""),
        scene_named("A") + "," + scene_named("a"), scene_named("A", "Sphere_3"),
        scene_named("A", "*", "left"), scene_named("A", "*", "left=1", "Nobody")}) {
    EXPECT_FALSE(lesson_.save(*atlas_, "p", "[" + bad + "]", true)) << bad;
  }
  EXPECT_EQ(read_bytes(file_), before);
  ASSERT_TRUE(write_bytes(file_, "another"));
  EXPECT_THAT(lesson_.save(*atlas_, "p", "[]", true),
              FailsWith(ErrorCode::kFailed, HasSubstr("has changed")));
  EXPECT_EQ(read_bytes(file_), "another");
  EXPECT_THAT(folder_.names(), testing::ElementsAre("a.atlas"));
}

TEST_F(LessonFileTest, GoesBesideAnAtlasThatIsReadOnly) {
  const std::string before = read_bytes(file_);
  ASSERT_TRUE(give_to_ordinary_user(folder_.path().c_str()));
  std::filesystem::permissions(file_, std::filesystem::perms(0444));
  ASSERT_TRUE(write_bytes(folder_.file("a.lesson.atlas"), "other"));
  ASSERT_TRUE(give_to_ordinary_user(folder_.file("a.lesson.atlas").c_str()));
  const OrdinaryUser user;
  EXPECT_EQ(save("p", scene_named("A")).text, "Replace the atlas in a.lesson.atlas?");
  EXPECT_EQ(read_bytes(folder_.file("a.lesson.atlas")), "other");
  EXPECT_EQ(save("p", scene_named("A"), true).text, "The lesson is saved in a.lesson.atlas.");
  EXPECT_EQ(save("p", scene_named("A") + "," + scene_named("B")).atlas->scenes().size(), 2U);
  EXPECT_EQ(read_bytes(file_), before);
  EXPECT_THAT(folder_.names(), testing::ElementsAre("a.atlas", "a.lesson.atlas"));
}

TEST_F(PageServerTest, SavesTheLessonOfAnOpenPage) {
  const auto save = [&](const std::string& scenes) {
    return reply_to(port(), post("/lesson" + query("&page=p"), "[" + scenes + "]"));
  };
  EXPECT_EQ(save(scene_named("A")).status, 410);
  const auto page = open_page();
  EXPECT_EQ(get("/lesson" + query("&page=p"), own_host()).status, 404);
  EXPECT_EQ(reply_to(port(), post("/lesson?page=p", "[]")).status, 403);
  const HttpReply refused = save(scene_named("A", "Sphere_3"));
  EXPECT_EQ(refused.status, 200) << "browsers log others";
  EXPECT_THAT(refused.body, StartsWith(R"(["refused","selection)"));
  EXPECT_EQ(get("/" + query(), own_host()).body, "<p>0 scenes</p>");
  EXPECT_EQ(save(scene_named("A")).body, "[\"saved\",\"The lesson is saved in a.atlas.\"]\n");
  EXPECT_EQ(get("/" + query(), own_host()).body, "<p>1 scenes</p>");
  EXPECT_EQ(Json::parse(call(0, R"({"call": "info"})").text).at("scenes").size(), 1U);
}

TEST(Door, HasATokenOfItsOwnAndATicketForOneUse) {
  const Door door = value_or_throw(Door::create());
  EXPECT_NE(door.address(1), value_or_throw(Door::create()).address(1));
  const std::string address = door.address_with_ticket(1);
  const std::string ticket = address.substr(address.find('=') + 1);
  EXPECT_FALSE(door.admits({.host = "evil.example", .origin = {}, .token = ticket, .cookie = {}}));
  EXPECT_TRUE(door.admits({.host = "127.0.0.1:1", .origin = {}, .token = ticket, .cookie = {}}));
  EXPECT_FALSE(door.admits({.host = "127.0.0.1:1", .origin = {}, .token = ticket, .cookie = {}}));
}

TEST(PageServer, NamesThePortThatIsTaken) {
  const auto atlas = open_in_memory(phantom_content());
  const auto first = value_or_throw(PageServer::start({.atlas = atlas, .html = page_of, .renderer = {}}));
  const std::string address = first->address();
  const auto port = static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
  EXPECT_THAT(PageServer::start({.atlas = atlas, .html = page_of, .renderer = {}, .port = port}),
              FailsWith(ErrorCode::kFailed, HasSubstr(std::to_string(port))));
}

}  // namespace
}  // namespace splatlas
