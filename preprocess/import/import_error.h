// Errors of files that cannot be imported.
#pragma once

#include <filesystem>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "format/result.h"

namespace splatlas {

/// kFailed: "FILE: " and the formatted text.
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> bad_file(const std::filesystem::path& path,
                                             fmt::format_string<Args...> text, Args&&... args) {
  return fail(ErrorCode::kFailed, path.string() + ": " + fmt::format(text, std::forward<Args>(args)...));
}

/// A library's message as one line without a full stop; `otherwise` if there is none.
[[nodiscard]] inline std::string one_line(const std::string& message, const std::string& otherwise) {
  std::istringstream words(message);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  line.erase(line.find_last_not_of(" .") + 1);
  return line.empty() ? otherwise : line;
}

}  // namespace splatlas
