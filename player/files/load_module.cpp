#include "player/files/load_module.h"

#include <dlfcn.h>

#include "format/result_macros.h"

namespace splatlas {

Result<void*> load_function(const char* module, const char* function, const char* library) {
  void* const handle = dlopen(module, RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    return fail(ErrorCode::kFailed, "cannot load {} ({}): {}", module, library,
                reason ? reason : "unknown reason");
  }
  void* const found = dlsym(handle, function);
  if (found != nullptr) return found;
  return fail(ErrorCode::kFailed, "{} has no {}: it is of another version", module, function);
}

TextDrawer::TextDrawer(const std::filesystem::path& font) {
  opening_ = std::async(std::launch::async, [file = font.string()]() -> OpenedTextEngine {
    SPLATLAS_ASSIGN_OR_RETURN(void* const function,
                              load_function(kTextModule, kOpenTextEngineName, "Pango and Cairo"));
    OpenedTextEngine engine;
    reinterpret_cast<OpenTextEngine>(function)(file, engine);
    return engine;
  });
}

Result<void> TextDrawer::wait() {
  if (opening_.valid()) opened_ = opening_.get();
  if (!opened_) return tl::unexpected(opened_.error());
  return {};
}

}  // namespace splatlas
