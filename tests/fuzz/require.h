// Requirements of fuzz targets.
#pragma once

#include <initializer_list>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// Aborts with a message, a finding, unless `holds`.
void require(bool holds, std::string_view what);

/// Requires one of these error codes and a message.
void require_error(const Error& error, std::initializer_list<ErrorCode> codes);

/// The value. An error is a finding.
template <typename T>
[[nodiscard]] T require_value(Result<T> result) {
  require(result.has_value(), result ? std::string_view() : std::string_view(result.error().message));
  return std::move(*result);
}

}  // namespace splatlas
