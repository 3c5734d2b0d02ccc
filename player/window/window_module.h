// C interface of the window module.
#pragma once

#include <cstddef>
#include <cstdint>

namespace splatlas {

inline constexpr int kWindowClosed = -1;

/// Shows the atlas at `path` until the user closes its window; for `threads` and `max_memory_bytes` see
/// RendererOptions, for `max_work` AtlasOptions. Returns
/// kWindowClosed, or the number of an ErrorCode with one line of text in `error`.
using ShowWindow = int (*)(const char* path, unsigned threads, std::uint64_t max_memory_bytes,
                           double max_work, char* error, std::size_t error_size);

inline constexpr const char* kWindowModule = "libsplatlas_window.so";
inline constexpr const char* kShowWindowName = "splatlas_show_window";

}  // namespace splatlas
