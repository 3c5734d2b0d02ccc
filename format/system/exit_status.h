// Exit statuses of the programs.
#pragma once

#include "format/result.h"

namespace splatlas {

/// The documented exit status of a program that ends with this error: 1, 2, 3 or 4.
[[nodiscard]] constexpr int exit_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUsage: return 2;
    case ErrorCode::kInvalidAtlas: return 3;
    case ErrorCode::kNotFound: return 4;
    case ErrorCode::kFailed:
    case ErrorCode::kLimit:
    case ErrorCode::kCancelled: break;
  }
  return 1;
}

}  // namespace splatlas
