// C interface of the window module.
#pragma once

#include <cstddef>

namespace splatlas {

inline constexpr int kWindowClosed = -1;

/// Shows the atlas at `path` until the user closes its window; for `max_work` see AtlasOptions. Returns
/// kWindowClosed, or the number of an ErrorCode with one line of text in `error`.
using ShowWindow = int (*)(const char* path, unsigned threads, double max_work, char* error,
                           std::size_t error_size);

inline constexpr const char* kWindowModule = "libsplatlas_window.so";
inline constexpr const char* kShowWindowName = "splatlas_show_window";

}  // namespace splatlas
