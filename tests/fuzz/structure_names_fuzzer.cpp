// Fuzz target: look-up of names, ids, paths and patterns in any graph, against an enumeration of all paths.
// Input: the number of structures, for each a byte of parents and a name of up to three letters, then the
// query.
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "format/selection.h"
#include "format/system/ascii_text.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/require.h"

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

/// Brute force over the length of each "*". Both arguments are in lower case.
bool matches(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] == '*')
    return matches(pattern.substr(1), text) || (!text.empty() && matches(pattern, text.substr(1)));
  return !text.empty() && pattern[0] == text[0] && matches(pattern.substr(1), text.substr(1));
}

/// Every path from any structure above (roots only if `whole`) down to `s`, in lower case.
void collect_paths(const StructureGraph& graph, StructureIndex s, const std::string& below, bool whole,
                   std::set<std::string>& paths) {
  const std::string path = to_lower(graph[s].name) + below;
  if (!whole || graph[s].parents.empty()) paths.insert(path);
  for (const StructureIndex parent : graph[s].parents) collect_paths(graph, parent, "/" + path, whole, paths);
}

template <typename Fits>
std::vector<StructureIndex> all_that(const StructureGraph& graph, const Fits& fits) {
  std::vector<StructureIndex> found;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    if (fits(s)) found.push_back(s);
  }
  return found;
}

/// The definition in selection.h.
std::vector<StructureIndex> find_by_definition(const StructureGraph& graph, const std::string& sought) {
  const auto paths = [&](StructureIndex s, bool whole) {
    std::set<std::string> all;
    collect_paths(graph, s, "", whole, all);
    return all;
  };
  if (sought.find('*') != std::string::npos) {
    return all_that(graph, [&](StructureIndex s) {
      std::set<std::string> texts = paths(s, sought.find('/') == std::string::npos);
      texts.insert({to_lower(graph[s].id), to_lower(graph[s].name)});
      return std::ranges::any_of(texts, [&](const std::string& text) { return matches(sought, text); });
    });
  }
  auto found = all_that(graph, [&](StructureIndex s) { return to_lower(graph[s].id) == sought; });
  if (found.empty())
    found = all_that(graph, [&](StructureIndex s) { return to_lower(graph[s].name) == sought; });
  if (found.empty() && sought.find('/') != std::string::npos)
    found = all_that(graph, [&](StructureIndex s) { return paths(s, false).contains(sought); });
  return found;
}

void fuzz(FuzzInput input) {
  const StructureGraph graph = read_graph(input);
  std::string sought;
  const bool of_letters = input.below(3) != 0;
  for (const std::byte b : input.take(20)) {
    const auto byte = std::to_integer<std::size_t>(b);
    sought += of_letters ? kLetters[byte % kLetters.size()] : static_cast<char>(byte);
  }
  if (std::ranges::count(sought, '*') > 6) return;  // brute force takes too long
  const auto expected = find_by_definition(graph, to_lower(sought));
  const auto found = find_structures(graph, sought);
  const bool is_pattern = sought.find('*') != std::string::npos;
  if (!found) {
    require_error(found.error(), {ErrorCode::kNotFound});
    require(expected.empty() || (!is_pattern && expected.size() > 1), "a structure is not found");
  } else {
    require(*found == expected, "other structures are found");
  }
}

}  // namespace
}  // namespace splatlas

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  splatlas::fuzz({data, size});
  return 0;
}
