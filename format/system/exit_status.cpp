#include "format/system/exit_status.h"

#include <cstdio>
#include <exception>
#include <new>

#include "format/system/ascii_text.h"

namespace splatlas {

int run_main(const char* name, const std::function<Result<void>()>& run, const char* remedy) try {
  const Result<void> result = run();
  if (result) return 0;
  std::fprintf(stderr, "%s: %s\n", name, printable(result.error().message).c_str());
  return exit_status(result.error().code);
} catch (const std::bad_alloc&) {
  std::fprintf(stderr, "%s: out of memory%s\n", name, remedy);
  return 1;
} catch (const std::exception& exception) {
  std::fprintf(stderr, "%s: %s\n", name, exception.what());
  return 1;
}

}  // namespace splatlas
