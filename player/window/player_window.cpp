#include "player/window/player_window.h"

#include <array>

#include <dlfcn.h>
#include <fmt/format.h>

#include "player/window/window_module.h"

namespace splatlas {
namespace {

tl::unexpected<Error> cannot_load(const char* reason) {
  return fail(ErrorCode::kFailed, fmt::format("cannot open a window: {}; use 'splatlas-player render'",
                                              reason != nullptr ? reason : kWindowModule));
}

}  // namespace

Result<void> run_window(const std::filesystem::path& atlas, unsigned threads) {
  // Never unloaded: OpenGL drivers leave threads and exit handlers behind.
  void* module = dlopen(kWindowModule, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (module == nullptr) return cannot_load(dlerror());
  void* function = dlsym(module, kShowWindowName);
  if (function == nullptr) return cannot_load(dlerror());
  std::array<char, 2048> error{};
  const auto show = reinterpret_cast<ShowWindow>(function);
  const int code = show(atlas.c_str(), threads, error.data(), error.size());
  if (code == kWindowClosed) return {};
  return fail(static_cast<ErrorCode>(code), error.data());
}

}  // namespace splatlas
