// Grids of builds with external surfaces.
#pragma once

#include <optional>
#include <span>

#include "preprocess/import/notes.h"
#include "preprocess/sources/source_model.h"

namespace splatlas {

/// The box of the labelled voxels in LPS mm; of the grid where there are none; nothing without a grid.
[[nodiscard]] std::optional<MmBox> labelled_box(const SourceModel& model);

/// Makes a grid around the meshes if the model has none. With `widens`, adds voxels to its grid until it
/// holds all meshes: background, and the least grey value. Notes it. kLimit beyond 8 times the voxels.
[[nodiscard]] Result<void> fit_grid(SourceModel& model, std::span<const TriangleMesh> meshes, bool widens,
                                    Notes& notes);

}  // namespace splatlas
