// Printing: the only writes to standard output and standard error. Exit statuses and outermost function of
// the programs.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "format/result.h"
#include "format/text/printable_text.h"

namespace splatlas {

/// Writes text to standard output and flushes; kFailed, with the reason, on error.
[[nodiscard]] Result<void> print_text(const PrintableText& text);

/// Writes a file's bytes to standard output and flushes; the same error.
[[nodiscard]] Result<void> print_bytes(std::span<const std::byte> bytes);

/// Flushes standard output; kFailed if this or any earlier write failed. To call last, to report lost output.
[[nodiscard]] Result<void> finish_standard_output();

/// Writes progress, notes and warnings to `stream`, usually standard error, and flushes. Ignores errors.
void print_to(std::FILE* stream, const PrintableText& text);

/// Writes "PROGRAM: MESSAGE" as one printable() line to standard error. Ignores errors; needs no memory to
/// report that memory is exhausted.
void print_error(const char* program, std::string_view message) noexcept;

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
