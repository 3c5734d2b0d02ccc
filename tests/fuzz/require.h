// What every fuzz target asks of what it calls.
#pragma once

#include <initializer_list>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// Ends the program, telling what does not hold: a finding.
void require(bool holds, std::string_view what);

/// Errors are of one of these kinds, and say something.
void require_error(const Error& error, std::initializer_list<ErrorCode> codes);

/// The value; an error is a finding.
template <typename T>
[[nodiscard]] T require_value(Result<T> result) {
  require(result.has_value(), result ? std::string_view() : std::string_view(result.error().message));
  return std::move(*result);
}

}  // namespace splatlas
