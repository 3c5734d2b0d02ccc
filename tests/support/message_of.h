// Messages of results in tests.
#pragma once

#include <string>

#include "format/result.h"

namespace splatlas {

/// The message of an error; "" for a value.
template <typename T>
[[nodiscard]] std::string message_of(const Result<T>& result) {
  return result ? "" : result.error().message;
}

}  // namespace splatlas
