// Formatted errors, and macros that return the error of a Result. Internal: public headers do not use them.
#pragma once

#include <utility>

#include <fmt/format.h>

#include "format/result.h"

namespace splatlas {

/// Makes an error with a formatted message.
template <typename... Args>
requires(sizeof...(Args) > 0)
    [[nodiscard]] tl::unexpected<Error> fail(ErrorCode code, fmt::format_string<Args...> text,
                                             Args&&... args) {
  return fail(code, fmt::format(text, std::forward<Args>(args)...));
}

/// kInvalidAtlas with a formatted message.
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> invalid_atlas(fmt::format_string<Args...> text, Args&&... args) {
  return fail(ErrorCode::kInvalidAtlas, fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace splatlas

/// Returns the error of `expression` (a Result) to the caller, if it has one.
#define SPLATLAS_RETURN_IF_ERROR(expression)                                          \
  do {                                                                                \
    if (auto splatlas_result = (expression); !splatlas_result) {                      \
      return ::tl::unexpected<::splatlas::Error>(std::move(splatlas_result).error()); \
    }                                                                                 \
  } while (false)

#define SPLATLAS_CONCAT_(a, b) a##b
#define SPLATLAS_CONCAT(a, b) SPLATLAS_CONCAT_(a, b)

/// `SPLATLAS_ASSIGN_OR_RETURN(auto x, f());` : x gets the value of f(), or the caller returns its error.
#define SPLATLAS_ASSIGN_OR_RETURN(declaration, expression) \
  SPLATLAS_ASSIGN_OR_RETURN_(SPLATLAS_CONCAT(splatlas_result_, __LINE__), declaration, expression)
#define SPLATLAS_ASSIGN_OR_RETURN_(result, declaration, expression)                   \
  auto result = (expression);                                                         \
  if (!result) return ::tl::unexpected<::splatlas::Error>(std::move(result).error()); \
  declaration = std::move(*result)
