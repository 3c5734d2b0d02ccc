// VTK without its messages on standard error.
#pragma once

#include <string>

#include <vtkAlgorithm.h>

namespace splatlas {

/// Runs filter.Update() and returns VTK's first error or warning, in one line; empty if there is none. From
/// the first call on, VTK's output window of this process is silent.
[[nodiscard]] std::string update_quietly(vtkAlgorithm& filter);

}  // namespace splatlas
