// VTK without its messages on standard error.
#pragma once

#include <string>

#include <vtkAlgorithm.h>

namespace splatlas {

/// Initialises VTK's object factories, and silences its output window in this process. VTK's own at its first
/// object is not thread-safe: call this before threads use VTK. Thread-safe; only the first call acts.
void initialize_vtk();

/// Runs filter.Update() and returns VTK's first error or warning, in one line; else empty. Initialises VTK.
[[nodiscard]] std::string update_quietly(vtkAlgorithm& filter);

}  // namespace splatlas
