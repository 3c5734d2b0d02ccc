// Fuzz target: look-up of names, ids, paths and patterns in any graph, against an enumeration of all paths.
// Input: the number of structures, for each a byte of parents and a name of up to three letters, then the
// query.
#include <string>
#include <vector>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "tests/fuzz/cost_limit.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"
#include "tests/support/find_slowly.h"

namespace splatlas {
namespace {

constexpr std::size_t kMaxFuzzedStructures = 7;
/// Letters of names and of a third of the queries, so that they often match.
constexpr std::string_view kLetters = "aB/*s 1_";

StructureGraph read_graph(FuzzInput& input) {
  std::vector<Structure> structures(1 + input.below(kMaxFuzzedStructures));
  for (std::size_t s = 0; s < structures.size(); ++s) {
    structures[s].id = fmt::format("s{}", s);
    const std::size_t parents = input.below(256);
    for (std::size_t p = 0; p < s; ++p) {
      if ((parents >> p & 1) != 0) structures[s].parents.push_back(static_cast<StructureIndex>(p));
    }
    for (std::size_t n = input.below(4); n > 0; --n)
      structures[s].name += kLetters[input.below(kLetters.size())];
  }
  return require_value(StructureGraph::build(std::move(structures)));
}

void fuzz_structure_names(FuzzInput input) {
  const StructureGraph graph = read_graph(input);
  std::string sought;
  const bool of_letters = input.below(3) != 0;
  for (const std::byte b : input.take(20)) {
    const auto byte = std::to_integer<std::size_t>(b);
    sought += of_letters ? kLetters[byte % kLetters.size()] : static_cast<char>(byte);
  }
  if (std::ranges::count(sought, '*') > 6) return;  // brute force takes too long
  const auto expected = find_slowly(graph, sought);
  const auto found = [&] {
    const CostLimit limit({.seconds = 0.1, .bytes = 1 << 20}, "StructureGraph::find()");
    return graph.find(sought);
  }();
  const bool is_pattern = sought.find('*') != std::string::npos;
  if (!found) {
    require_error(found.error(), {ErrorCode::kNotFound});
    require(expected.empty() || (!is_pattern && expected.size() > 1), "a structure is not found");
  } else {
    require(*found == expected, "other structures are found");
  }
}

/// Enumerating the matches of up to six "*" in 20 letters on all paths takes up to half a second.
/// StructureGraph::find() has a limit of its own.
const FuzzTarget kStructureNames("structure_names", fuzz_structure_names,
                                 InputLimit{.floor = {2, 8 << 20}, .per_byte = {}});

}  // namespace
}  // namespace splatlas
