// Result values in test helpers; an error throws.
#pragma once

#include <stdexcept>
#include <utility>

#include "format/result.h"

namespace splatlas {

template <typename T>
T value_or_throw(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return *std::move(result);
}

}  // namespace splatlas
