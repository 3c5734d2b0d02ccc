// Result<T>: error handling without exceptions.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace splatlas {

/// Kind of a failure. Programs map it to an exit status with exit_status().
enum class ErrorCode {
  kFailed,        ///< the operation failed: a file is missing, unreadable, unwritable or of the wrong type
  kUsage,         ///< wrong usage: an option, a value out of range, selection syntax
  kInvalidAtlas,  ///< not an atlas, a damaged one, or one of a newer format version
  kNotFound,      ///< the name of a structure is unknown or ambiguous
  kLimit,         ///< needs more memory or a larger picture than allowed; nothing was allocated
};

/// A failure. The message is one line: file, fault, value, remedy.
struct Error {
  ErrorCode code = ErrorCode::kFailed;
  std::string message;
};

/// A value or an Error. Callers must check before they access the value.
template <typename T>
using Result = tl::expected<T, Error>;

/// Makes an error that converts to any Result.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// Exit status of a program that ends with this error: 1, 2, 3 or 4.
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

/// Returns the error of `expression` (a Result), if any, from the enclosing function.
#define SPLATLAS_RETURN_IF_ERROR(expression)                                          \
  do {                                                                                \
    if (auto splatlas_result = (expression); !splatlas_result) {                      \
      return ::tl::unexpected<::splatlas::Error>(std::move(splatlas_result).error()); \
    }                                                                                 \
  } while (false)

#define SPLATLAS_CONCAT_(a, b) a##b
#define SPLATLAS_CONCAT(a, b) SPLATLAS_CONCAT_(a, b)

/// `SPLATLAS_ASSIGN_OR_RETURN(auto x, f());` assigns the value of f() to x, or returns its error from the
/// enclosing function.
#define SPLATLAS_ASSIGN_OR_RETURN(declaration, expression) \
  SPLATLAS_ASSIGN_OR_RETURN_(SPLATLAS_CONCAT(splatlas_result_, __LINE__), declaration, expression)
#define SPLATLAS_ASSIGN_OR_RETURN_(result, declaration, expression)                   \
  auto result = (expression);                                                         \
  if (!result) return ::tl::unexpected<::splatlas::Error>(std::move(result).error()); \
  declaration = std::move(*result)
