// Errors of files that cannot be imported.
#pragma once

#include <filesystem>
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

}  // namespace splatlas
