// Functions of modules that are loaded at run time.
#pragma once

#include "format/result.h"

namespace splatlas {

/// Loads a module and finds a function. Modules are never unloaded. kFailed with the reason; `library` names
/// the module's main dependency. Thread-safe.
[[nodiscard]] Result<void*> load_function(const char* module, const char* function, const char* library);

}  // namespace splatlas
