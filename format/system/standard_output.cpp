#include "format/system/standard_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "format/system/result_macros.h"

namespace splatlas {
namespace {

tl::unexpected<Error> cannot_write(const char* reason) {
  return fail(ErrorCode::kFailed, "standard output: cannot be written: {}", reason);
}

}  // namespace

Result<void> print_text(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) return finish_standard_output();
  return cannot_write(std::strerror(errno));
}

Result<void> finish_standard_output() {
  const bool failed_before = std::ferror(stdout) != 0;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && !failed_before) return {};
  return cannot_write(flushed ? "an earlier write failed" : std::strerror(errno));
}

}  // namespace splatlas
