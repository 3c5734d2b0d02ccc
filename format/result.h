// Errors as values: every library function that can fail returns Result<T>.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace splatlas {

/// What kind of failure happened. Programs map these to exit statuses with exit_status().
enum class ErrorCode {
  kFailed,        ///< could not be done: a file is missing, unreadable, unwritable, of the wrong type
  kUsage,         ///< the caller's words are wrong: an option, a value out of range, selection syntax
  kInvalidAtlas,  ///< not an atlas, a damaged one, or one of a version that is too new
  kNotFound,      ///< a structure's name is unknown or ambiguous
  kLimit,         ///< would need more memory or a larger picture than allowed; nothing was allocated
};

/// One failure, told in one line: which file, what is wrong, the value, what to do.
struct Error {
  ErrorCode code = ErrorCode::kFailed;
  std::string message;
};

/// A value or an Error. Callers must look before they take the value.
template <typename T>
using Result = tl::expected<T, Error>;

/// Makes the failing side of any Result.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// The documented exit status of a program that ends with this error: 1, 2, 3 or 4.
[[nodiscard]] constexpr int exit_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUsage: return 2;
    case ErrorCode::kInvalidAtlas: return 3;
    case ErrorCode::kNotFound: return 4;
    case ErrorCode::kFailed:
    case ErrorCode::kLimit: break;
  }
  return 1;
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
