// Result<T>: error handling without exceptions.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <tl/expected.hpp>

namespace splatlas {

/// Kind of a failure.
enum class ErrorCode {
  kFailed,        ///< the operation failed: a file is missing, unreadable, unwritable or of the wrong type
  kUsage,         ///< wrong usage: an option, a value out of range, selection syntax
  kInvalidAtlas,  ///< not an atlas, a damaged one, or one of a newer format version
  kNotFound,      ///< the name of a structure is unknown or ambiguous
  kLimit,         ///< needs more memory or a larger picture than allowed; nothing was allocated
  kCancelled,     ///< the caller asked for a stop
};

/// A failure. The message is one line: file, fault, value, remedy. It quotes names from files and command
/// lines: print it with printable().
struct Error {
  ErrorCode code = ErrorCode::kFailed;
  std::string message;
  /// Start of the message, if it names a file or a parameter: "brain.atlas", "camera: zoom". Else empty.
  std::string subject = {};
};

/// A value or an Error. Callers must check before they access the value.
template <typename T>
using Result = tl::expected<T, Error>;

/// Makes an error that converts to any Result.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message), {}});
}

/// The value, for programs that end at their first error. Throws std::runtime_error with the error's message.
template <typename T>
T value_or_throw(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

/// Makes text safe for one line of a terminal: replaces characters that a terminal interprets, that reorder
/// text or that show nothing by "?", and bytes that are not UTF-8 by "\xNN".
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace splatlas
