// Exit statuses and outermost function of the programs.
#pragma once

#include <filesystem>
#include <functional>

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

/// Runs the work on one file. Exceptions become errors that name the file: std::bad_alloc is kLimit with
/// `remedy`, an imperative sentence; others are kFailed.
[[nodiscard]] Result<void> run_on_file(const std::filesystem::path& file, const char* remedy,
                                       const std::function<Result<void>()>& run);

/// Runs a program: prints its error or exception to standard error, after its name. Returns the exit status.
[[nodiscard]] int run_main(const char* name, const std::function<Result<void>()>& run);

}  // namespace splatlas
