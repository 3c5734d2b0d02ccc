#include "format/program/standard_output.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <new>

#include "format/io/memory_limit.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

tl::unexpected<Error> cannot_write(const char* reason) {
  return fail(ErrorCode::kFailed, "standard output: cannot be written: {}", reason);
}

}  // namespace

Result<void> print_text(const PrintableText& text) {
  return print_bytes(std::as_bytes(std::span(text.text())));
}

Result<void> print_bytes(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size()) return finish_standard_output();
  return cannot_write(std::strerror(errno));
}

Result<void> finish_standard_output() {
  const bool failed_before = std::ferror(stdout) != 0;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && !failed_before) return {};
  return cannot_write(flushed ? "an earlier write failed" : std::strerror(errno));
}

void print_to(std::FILE* stream, const PrintableText& text) {
  std::fwrite(text.text().data(), 1, text.text().size(), stream);
  std::fflush(stream);
}

void print_error(const char* program, std::string_view message) noexcept {
  try {
    print_to(stderr, PrintableText("{}: {}\n", program, message));
  } catch (const std::exception&) {  // std::bad_alloc
    std::fputs(program, stderr);
    std::fputs(": out of memory\n", stderr);
  }
}

Result<void> run_on_file(const std::filesystem::path& file, const char* remedy,
                         const std::function<Result<void>()>& run) {
  try {
    return run();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, "{}: out of memory; {}", file.string(), remedy);
  } catch (const std::exception& exception) {
    return fail(ErrorCode::kFailed, "{}: {}", file.string(), exception.what());
  }
}

int run_main(const char* name, const std::function<Result<void>()>& run) try {
  const Result<void> result = run();
  if (result) return 0;
  print_error(name, result.error().message);
  return exit_status(result.error().code);
} catch (const std::bad_alloc&) {
  print_error(name, std::string("out of memory; ") + kOutOfMemoryRemedy);
  return 1;
} catch (const std::exception& exception) {
  print_error(name, exception.what());
  return 1;
}

}  // namespace splatlas
