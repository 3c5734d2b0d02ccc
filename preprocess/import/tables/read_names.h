// Reader of label name files and colour tables.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/color.h"
#include "format/result.h"
#include "preprocess/import/tables/source_structure.h"

namespace splatlas {

/// A structure from a line of a names file; it has a label.
struct LabelName : SourceStructure {
  std::size_t line = 0;  ///< line number in the file, for messages
};

/// Reads one label per line: "label name [code]" (AAL and most others; quote a name that ends in a number),
/// or the eight columns of ITK-SNAP, `label R G B A visible mesh "name"`. Ignores blank lines, lines that
/// start with "#", and label 0 (background). kFailed, with file and line, for labels outside 0 to 2^32 - 1,
/// duplicate labels, colours outside 0 to 255, and quotes without an end. Also for missing names, duplicate
/// names (ignoring case), and names that check_structure_name() refuses.
[[nodiscard]] Result<std::vector<LabelName>> read_names(const std::filesystem::path& path);

/// Reads a colour table of 768 bytes (MRIcron's .lut: 256 reds, 256 greens, 256 blues), indexed by label.
/// kFailed for any other length.
[[nodiscard]] Result<std::array<Rgb, 256>> read_color_table(const std::filesystem::path& path);

}  // namespace splatlas
