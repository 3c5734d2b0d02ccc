#include "player/window/session/session_log.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace splatlas {

Result<SessionLog> SessionLog::from_environment() {
  const char* path = std::getenv(kSessionLogVariable);
  if (path == nullptr || *path == '\0') return SessionLog();
  return to_file(path);
}

Result<SessionLog> SessionLog::to_file(const std::filesystem::path& path) {
  SessionLog log;
  log.file_.reset(std::fopen(path.c_str(), "ae"));
  if (!log.file_) {
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written: {}; {} names it", path.string(),
                                                std::strerror(errno), kSessionLogVariable));
  }
  return log;
}

void SessionLog::write(std::string_view event, const nlohmann::ordered_json& fields) const {
  if (!file_) return;
  nlohmann::ordered_json line{{"event", event}};
  line.update(fields);
  // Names come from untrusted files: replace invalid UTF-8 instead of throwing.
  const std::string text = line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  std::fwrite(text.data(), 1, text.size(), file_.get());
  std::fflush(file_.get());
}

}  // namespace splatlas
