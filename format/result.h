// Errors as values: every library function that can fail returns Result<T>.
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace splatlas {

/// Kind of a failure.
enum class ErrorCode {
  kFailed,        ///< could not be done: a file is missing, unreadable, unwritable, of the wrong type
  kUsage,         ///< the caller's words are wrong: an option, a value out of range, selection syntax
  kInvalidAtlas,  ///< not an atlas, a damaged one, or one of a version that is too new
  kNotFound,      ///< a structure's name is unknown or ambiguous
  kLimit,         ///< would need more memory or a larger picture than allowed; nothing was allocated
  kCancelled,     ///< the caller has asked for a stop (RenderControl)
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

}  // namespace splatlas
