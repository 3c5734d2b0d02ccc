// Event log of the window as JSON lines, for tests.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "format/result.h"

namespace splatlas {

/// Environment variable with the path of the log file.
inline constexpr const char* kSessionLogVariable = "SPLATLAS_WINDOW_LOG";

/// Appends a JSON object per line for each visible change, so that scripts can wait for it and check it. The
/// values of "event":
///   layout     positions of the view and of the rows' items changed, in window coordinates
///   ready      the window is on screen
///   picture    a picture was shown: quality, final, size, camera, selection text, ms
///   pointer    id and name of the structure under the pointer; null for the background
///   current    the current structure changed
///   selection  text of the selection
///   text_error, status    a message, as shown
///   closed     the window is closed
/// Writes nothing without the environment variable. For the window's thread only.
class SessionLog {
 public:
  SessionLog() = default;
  /// Opens the file of the environment variable. kFailed if it cannot be written.
  [[nodiscard]] static Result<SessionLog> from_environment();
  [[nodiscard]] static Result<SessionLog> to_file(const std::filesystem::path& path);

  [[nodiscard]] bool on() const { return file_ != nullptr; }
  void write(std::string_view event, const nlohmann::ordered_json& fields) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace splatlas
