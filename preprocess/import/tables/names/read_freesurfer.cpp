// FreeSurfer's colour tables, also those of FastSurfer with a header line: id name R G B A [type].
// A is transparency, and a few tables hide structures by it. All are shown opaque here.
#include "preprocess/import/tables/names/color_rows.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

bool recognise_freesurfer(std::string_view head, std::string_view /*file*/) {
  if (head.starts_with("# Color table file")) return false;
  const ColorRowsOfHead rows = inspect_color_rows(head);
  if (!rows.are_most) return false;
  if (head.find("#No. Label Name") != std::string_view::npos || rows.are_transparencies) return true;
  const std::vector<TextLine> lines = lines_of(head);
  const std::vector<std::string_view> first = split_blanks(lines.front().text);
  return first.size() > 1 && first[0] == "ID" && first[1] == "LabelName";
}

Result<void> read_freesurfer(const NamesInput& input, NamesCollector& into) {
  add_color_rows(input, false, into);
  return {};
}

}  // namespace splatlas
