// Fuzz target: names files and tree files.
// Input: a names file, a line "----", a tree file.
#include <cstdint>
#include <optional>
#include <set>

#include "preprocess/import/tables/names_table.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/structures/build_graph.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/scratch_file.h"

namespace splatlas {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// Nothing if the names are refused.
std::optional<std::vector<SourceStructure>> read_sources(std::string_view text) {
  Notes notes;
  const auto names = read_names(write_input_file("names.txt", bytes_of(text)), NamesFormat::kAuto, notes);
  if (!names) {
    require_error(names.error(), {ErrorCode::kFailed});
    return std::nullopt;
  }
  std::vector<SourceStructure> sources;
  std::set<std::int64_t> labels;
  for (const LabelName& name : names->names) {
    require(!name.label || (name.label > 0 && name.label <= 0xffffffff && labels.insert(*name.label).second),
            "a label twice");
    require(check_structure_name(name.name).has_value(), "a name that is none");
    sources.push_back(name);
  }
  return sources;
}

void check_placed(const PlacedStructures& placed, const std::vector<SourceStructure>& sources) {
  require(placed.index_of_source.size() == sources.size(), "sources and their places differ in number");
  std::set<StructureIndex> places;
  for (std::size_t n = 0; n < sources.size(); ++n) {
    const StructureIndex place = placed.index_of_source[n];
    require(place < placed.graph.size() && places.insert(place).second, "a source has no place of its own");
    require(placed.graph[place].name == sources[n].name && placed.graph[place].label == sources[n].label,
            "a source is at another one's place");
  }
}

void fuzz_names_and_trees(FuzzInput input) {
  const std::string_view text = input.rest_as_text();
  constexpr std::string_view kSeparator = "\n----\n";
  const std::size_t end = text.find(kSeparator);
  const std::string_view tree = end == std::string_view::npos ? "" : text.substr(end + kSeparator.size());
  Notes notes;
  const auto lines = read_tree(write_input_file("tree.txt", bytes_of(tree)), notes);
  if (!lines) require_error(lines.error(), {ErrorCode::kFailed});
  const auto sources = read_sources(text.substr(0, end));
  if (!lines || !sources) return;
  const auto placed = build_graph(*sources, *lines, "tree.txt", notes);
  if (!placed) return require_error(placed.error(), {ErrorCode::kFailed});
  check_placed(*placed, *sources);
}

const FuzzTarget kNamesAndTrees("names_and_trees", fuzz_names_and_trees);

}  // namespace
}  // namespace splatlas
