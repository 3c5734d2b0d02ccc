// Structure lookup by id, name, path, term or wildcard pattern.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/result_macros.h"
#include "format/selection/glob.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

constexpr std::size_t kMaxListed = 5;  // names in a message
/// Length limits in bytes, which bound the cost of matching and of edit distances.
constexpr std::size_t kMaxPattern = 256;
constexpr std::size_t kMaxCompared = 64;

/// True if `path` is a suffix of a path from a root to `s`, at a "/" or in whole.
bool is_path_suffix(const StructureGraph& graph, StructureIndex s, std::string_view path) {
  // Names may contain "/", so that several splits are possible. A state is a structure and the length of the
  // path that remains for it and its ancestors.
  using State = std::pair<StructureIndex, std::size_t>;
  std::set<State> seen;
  std::vector<State> open{{s, path.size()}};
  while (!open.empty()) {
    check_task();
    const State state = open.back();
    open.pop_back();
    if (!seen.insert(state).second) continue;
    const auto [here, length] = state;
    const std::string& name = graph[here].name;
    if (name.size() > length || !equal_ignoring_case(name, path.substr(length - name.size(), name.size())))
      continue;
    const std::size_t rest = length - name.size();
    if (rest == 0) return true;
    if (path[rest - 1] != '/') continue;
    for (const StructureIndex parent : graph[here].parents) open.emplace_back(parent, rest - 1);
  }
  return false;
}

template <typename Matches>
std::vector<StructureIndex> filter_structures(const StructureGraph& graph, const Matches& matches) {
  std::vector<StructureIndex> result;
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    if (matches(s)) result.push_back(s);
  }
  return result;
}

/// The structures with a term that fits.
template <typename Fits>
std::vector<StructureIndex> match_terms(const StructureGraph& graph, const Fits& fits) {
  return filter_structures(graph, [&](StructureIndex s) {
    return std::ranges::any_of(graph[s].terms, [&](const Term& term) {
      check_task();
      return fits(term.value);
    });
  });
}

std::vector<StructureIndex> match_exact(const StructureGraph& graph, std::string_view name) {
  auto found =
      filter_structures(graph, [&](StructureIndex s) { return equal_ignoring_case(graph[s].id, name); });
  if (found.empty()) {
    found =
        filter_structures(graph, [&](StructureIndex s) { return equal_ignoring_case(graph[s].name, name); });
  }
  if (found.empty() && name.find('/') != std::string_view::npos) {
    found = filter_structures(graph, [&](StructureIndex s) { return is_path_suffix(graph, s, name); });
  }
  if (found.empty()) {
    found = match_terms(graph, [&](const std::string& term) { return equal_ignoring_case(term, name); });
  }
  return found;
}

/// Matches ids, names and paths; path suffixes, too, if the pattern contains a "/"; terms if none of these
/// fits. Propagates the states of the automaton down the graph, merged over parents, because the number of
/// paths may be exponential.
std::vector<StructureIndex> match_wildcard(const StructureGraph& graph, std::string_view pattern) {
  const Glob glob(pattern);
  const bool begins_anywhere = pattern.find('/') != std::string_view::npos;
  std::vector<Glob::States> after_path(graph.size());
  for (const StructureIndex s : graph.topological()) {
    check_task();
    Glob::States before = begins_anywhere || graph[s].parents.empty() ? glob.start() : glob.none();
    for (const StructureIndex parent : graph[s].parents) {
      Glob::merge(glob.read(after_path[parent], "/"), before);
    }
    after_path[s] = glob.read(std::move(before), graph[s].name);
  }
  auto found = filter_structures(graph, [&](StructureIndex s) {
    return glob.accepts(after_path[s]) || glob.matches(graph[s].id) || glob.matches(graph[s].name);
  });
  if (found.empty()) {
    found = match_terms(graph, [&](const std::string& term) { return glob.matches(term); });
  }
  return found;
}

/// Levenshtein distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// Names that contain the text, then names by edit distance: one a structure, of its name, id and terms.
std::vector<std::string> nearest_names(const StructureGraph& graph, std::string_view text) {
  std::string query = to_lower(text.substr(0, kMaxCompared));
  std::erase(query, '*');
  const auto distance_to = [&](const std::string& name) -> std::size_t {
    check_task();
    const std::string lowered = to_lower(std::string_view(name).substr(0, kMaxCompared));
    if (query.size() >= 3 && lowered.find(query) != std::string::npos) return 0;
    return edit_distance(query, lowered);
  };
  std::set<std::pair<std::size_t, std::string>> nearest;
  for (const Structure& s : graph.structures()) {
    std::pair best(distance_to(s.name), &s.name);
    const auto consider = [&](const std::string& name) {
      if (const std::size_t distance = distance_to(name); distance < best.first) best = {distance, &name};
    };
    consider(s.id);
    for (const Term& term : s.terms) consider(term.value);
    nearest.emplace(best.first, *best.second);
    if (nearest.size() > kMaxListed) nearest.erase(std::prev(nearest.end()));
  }
  std::vector<std::string> names;
  names.reserve(nearest.size());
  for (const auto& [distance, name] : nearest) names.push_back(in_quotes(name));
  return names;
}

tl::unexpected<Error> not_found(const StructureGraph& graph, std::string_view name) {
  const std::string nearest = fmt::format("{}", fmt::join(nearest_names(graph, name), ", "));
  return fail(ErrorCode::kNotFound, "no structure is called {}; {}", in_quotes(name),
              nearest.empty() ? "there are none" : "the nearest: " + nearest);
}

tl::unexpected<Error> ambiguous(const StructureGraph& graph, std::string_view name,
                                std::span<const StructureIndex> found) {
  std::vector<std::string> candidates;
  for (const StructureIndex s : found.first(std::min(found.size(), kMaxListed))) {
    candidates.push_back(fmt::format("{} (id {})", in_quotes(graph.paths(s, 1).front()), graph[s].id));
  }
  if (found.size() > kMaxListed) candidates.push_back(fmt::format("{} more", found.size() - kMaxListed));
  return fail(ErrorCode::kNotFound, "{} stands for {} structures, write a longer path or an id: {}",
              in_quotes(name), found.size(), fmt::join(candidates, ", "));
}

}  // namespace

Result<std::vector<StructureIndex>> StructureGraph::find(std::string_view name) const {
  const StructureGraph& graph = *this;
  const bool wildcard = name.find('*') != std::string_view::npos;
  if (wildcard && name.size() > kMaxPattern) return not_found(graph, name);
  auto found = wildcard ? match_wildcard(graph, name) : match_exact(graph, name);
  if (found.empty()) return not_found(graph, name);
  if (!wildcard && found.size() > 1) return ambiguous(graph, name, found);
  return found;
}

Result<StructureIndex> StructureGraph::find_label(std::int64_t label) const {
  const StructureGraph& graph = *this;
  const auto found = filter_structures(graph, [&](StructureIndex s) { return graph[s].label == label; });
  if (found.size() == 1) return found.front();
  if (!found.empty()) return ambiguous(graph, fmt::format("#{}", label), found);
  return fail(ErrorCode::kNotFound, "no structure has the label {}; splatlas-player info --json lists them",
              label);
}

}  // namespace splatlas
