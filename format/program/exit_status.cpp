#include "format/program/exit_status.h"

#include <exception>
#include <new>
#include <string>

#include "format/io/memory_limit.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"

namespace splatlas {

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
