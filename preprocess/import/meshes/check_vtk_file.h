// Check of legacy VTK files before VTK reads them.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// kFailed for a legacy VTK file that is no POLYDATA, lacks points or corners that its header promises, or
/// whose polygons do not fill their list. VTK crashes at such files, or reads a part. Corner indices and
/// attributes are not checked. Cost: one pass; memory for the file.
[[nodiscard]] Result<void> check_vtk_file(const std::filesystem::path& path);

}  // namespace splatlas
