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
namespace {

constexpr const char* kAddress = "http://127.0.0.1:{}/?token={}";

/// Takes the same time for all texts of this length.
bool is_same(std::string_view text, std::string_view secret) {
  return text.size() == secret.size() && memeql_sec(text.data(), secret.data(), secret.size()) != 0;
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

}  // namespace splatlas
