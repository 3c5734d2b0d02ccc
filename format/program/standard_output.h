// Printing: the only writes to standard output and standard error.
#pragma once

#include <cstddef>
#include <cstdio>
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

}  // namespace splatlas
