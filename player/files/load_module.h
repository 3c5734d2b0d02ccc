// Modules that are loaded at run time: their functions, and the engine of texts.
#pragma once

#include <filesystem>
#include <future>

#include "format/result.h"
#include "player/files/text_module.h"

namespace splatlas {

/// Loads a module and finds a function. Modules are never unloaded. kFailed with the reason; `library` names
/// the module's main dependency. Thread-safe.
[[nodiscard]] Result<void*> load_function(const char* module, const char* function, const char* library);

/// The text engine, which is loaded in the background. Not thread-safe.
class TextDrawer {
 public:
  /// Begins to load the module and the fonts. `font`: a file to prefer to those of the system; empty: none.
  explicit TextDrawer(const std::filesystem::path& font);

  /// Waits for the module. kFailed if it cannot be loaded, or without a usable font.
  [[nodiscard]] Result<void> wait();
  /// After wait().
  [[nodiscard]] TextEngine* operator->() const { return opened_->get(); }

 private:
  std::future<OpenedTextEngine> opening_;
  OpenedTextEngine opened_;
};

}  // namespace splatlas
