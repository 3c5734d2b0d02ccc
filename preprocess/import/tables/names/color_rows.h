// Rows "label name R G B A" of 3D Slicer's and FreeSurfer's colour tables.
#pragma once

#include <string_view>
#include <vector>

#include "preprocess/import/tables/names_collector.h"

namespace splatlas {

/// A row, split at blanks. The parts refer to the line.
struct ColorRow {
  std::string_view label;
  std::string name;                      ///< words joined by one blank
  std::vector<std::string_view> colors;  ///< R G B, and A if given
};

/// Splits "label name R G B [A [type]]". Nullopt unless the label is whole and the last words are colours.
[[nodiscard]] std::optional<ColorRow> split_color_row(std::string_view line);

/// Statistics of the rows of a head: whether most lines are such rows, and the meaning of their last column.
struct ColorRowsOfHead {
  bool are_most = false;
  bool are_transparencies = false;  ///< FreeSurfer: A is mostly 0, which is opaque there
};
[[nodiscard]] ColorRowsOfHead inspect_color_rows(std::string_view head);

/// Adds all rows. Lines that do not begin with a whole number are comments, as both programs take them. With
/// `underscores_are_blanks`, "_" in a name is a blank.
void add_color_rows(const NamesInput& input, bool underscores_are_blanks, NamesCollector& into);

}  // namespace splatlas
