// 3D Slicer's colour tables: index name R G B A.
#include "preprocess/import/tables/names/color_rows.h"
#include "preprocess/import/tables/names/dialects.h"

namespace splatlas {
namespace {

constexpr std::string_view kTable = "# Color table file";
constexpr std::string_view kRamp = "# Color procedural file";

}  // namespace

bool recognise_ctbl(std::string_view head, std::string_view /*file*/) {
  return head.starts_with(kTable) || head.starts_with(kRamp) || inspect_color_rows(head).are_most;
}

Result<void> read_ctbl(const NamesInput& input, NamesCollector& into) {
  if (input.text.starts_with(kRamp)) {
    return input.refuse("line 1: is a colour ramp (\"Color procedural file\"), which names no labels");
  }
  add_color_rows(input, true, into);
  return {};
}

}  // namespace splatlas
