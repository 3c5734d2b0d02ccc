// VTK without its messages on standard error.
#pragma once

#include <string>

#include <vtkAlgorithm.h>

namespace splatlas {

/// Runs filter.Update() and returns the first thing that VTK complained about, in one line; empty when
/// nothing. From the first call on, VTK's output window of this process is silent.
[[nodiscard]] std::string update_quietly(vtkAlgorithm& filter);

}  // namespace splatlas
