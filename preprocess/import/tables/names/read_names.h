// Reader of label name files and colour tables.
#pragma once

#include <array>
#include <filesystem>

#include "format/content/color.h"
#include "format/result.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Reads names in one of the dialects; kAuto detects it from the content. Rows with faults are dropped, and
/// the first of several rows of a label is kept: `notes` counts these by kind, and tells the dialect. Labels
/// without a name become "Label 7". kFailed if the file cannot be read, is of no known or of another dialect,
/// or if no row is usable; the message tells the first fault. Cost: linear in the file, at most 16 MiB.
[[nodiscard]] Result<NamesTable> read_names(const std::filesystem::path& path, NamesFormat format,
                                            Notes& notes);

/// Reads a colour table of 768 bytes (MRIcron's .lut: 256 reds, 256 greens, 256 blues), indexed by label.
/// kFailed for any other length.
[[nodiscard]] Result<std::array<Rgb, 256>> read_color_table(const std::filesystem::path& path);

}  // namespace splatlas
