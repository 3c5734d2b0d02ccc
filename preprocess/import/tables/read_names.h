// Names files: what the labels of a label map are called.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/color.h"
#include "format/result.h"

namespace splatlas {

struct LabelName {
  std::int64_t label = 0;
  std::string name;
  std::optional<std::int64_t> code;  ///< AAL's third column: a number that says where the label belongs
  std::optional<Rgb> color;
  std::size_t line = 0;  ///< of the file, for messages
};

/// Reads one label a line: either "label name [code]" (AAL and most others; quote a name that ends in a
/// number), or the eight columns of ITK-SNAP, `label R G B A visible mesh "name"`. Blank lines and lines that
/// start with "#" do not count, nor does label 0, the background. kFailed names file and line of the first
/// fault: a label that is no number from 0 to 2^32 - 1, a label named twice, a missing name, one that
/// check_structure_name refuses, one that two labels share (case aside).
[[nodiscard]] Result<std::vector<LabelName>> read_names(const std::filesystem::path& path);

/// Reads a colour table of 768 bytes (MRIcron's .lut: 256 reds, 256 greens, 256 blues): entry n is label n's.
[[nodiscard]] Result<std::array<Rgb, 256>> read_color_table(const std::filesystem::path& path);

}  // namespace splatlas
