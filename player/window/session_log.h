// What the window shows, as lines of JSON: a testing aid.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "format/result.h"

namespace splatlas {

/// Name of the environment variable that names the file.
inline constexpr const char* kSessionLogVariable = "SPLATLAS_WINDOW_LOG";

/// Appends one JSON object per line for everything that the user could see change, so that a script which
/// moves the mouse can wait for, and check, what a person would have seen. Each has "event":
///   layout     places of the view and of the rows' mode buttons, in window coordinates; when they change
///   ready      the window is on screen
///   picture    a picture was shown: quality, final, size, camera, selection text, ms
///   pointer    structure (id) and name under the pointer; null where the background shows
///   current    the structure chosen by a click
///   selection  text of the selection
///   text_error, status    a message, as shown
///   closed     the window is gone
/// Without the variable nothing is written. For the window's thread.
class SessionLog {
 public:
  SessionLog() = default;
  /// By the environment variable; kFailed when it names a file that cannot be written.
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
