#include "player/window/window_module.h"

#include <exception>

#include <fmt/format.h>

#include "player/window/window_loop.h"

// Check the definition against the type that the program loads.
extern "C" __attribute__((visibility("default"))) int splatlas_show_window(const char* path, unsigned threads,
                                                                           char* error,
                                                                           std::size_t error_size) try {
  if (const auto result = splatlas::run_window_loop(path, threads); !result) {
    *fmt::format_to_n(error, error_size - 1, "{}", result.error().message).out = '\0';
    return static_cast<int>(result.error().code);
  }
  return splatlas::kWindowClosed;
} catch (const std::exception& exception) {
  *fmt::format_to_n(error, error_size - 1, "{}", exception.what()).out = '\0';
  return static_cast<int>(splatlas::ErrorCode::kFailed);
}
