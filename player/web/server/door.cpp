#include "player/web/server/door.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nettle/memops.h>
#include <sys/random.h>

#include "format/result_macros.h"

namespace splatlas {

Result<Door> Door::create() {
  std::array<std::uint8_t, 24> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return fail(ErrorCode::kFailed, "no random numbers: {}", std::strerror(errno));
  const std::string digits = fmt::format("{:02x}", fmt::join(bytes, ""));
  return Door(digits.substr(0, 32), "splatlas-" + digits.substr(32));
}

bool Door::is_token(std::string_view text) const {
  return text.size() == token_.size() && memeql_sec(text.data(), token_.data(), token_.size()) != 0;
}

bool Door::admits(const Knock& knock) const {
  const std::string_view name = knock.host.substr(0, knock.host.find(':'));
  const std::string_view port = knock.host.substr(std::min(name.size() + 1, knock.host.size()));
  const bool is_here = (name == "127.0.0.1" || name == "localhost") &&
                       std::ranges::all_of(port, [](char c) { return c >= '0' && c <= '9'; });
  const bool is_own = knock.origin.empty() || knock.origin == fmt::format("http://{}", knock.host);
  return is_here && is_own && (is_token(knock.token) || is_token(knock.cookie));
}

std::string Door::address(std::uint16_t port) const {
  return fmt::format("http://127.0.0.1:{}/?token={}", port, token_);
}

std::string Door::cookie() const {
  return fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict", cookie_name_, token_);
}

}  // namespace splatlas
