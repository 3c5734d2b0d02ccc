#include "preprocess/structures/build_graph.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "format/selection.h"
#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// "Thalamus", or "Thalamus_2" if that is taken.
std::string unique_id(const std::string& name, std::set<std::string>& taken) {
  const std::string base = id_from_name(name);
  std::string id = base;
  for (int n = 2; !taken.insert(to_lower(id)).second; ++n) id = fmt::format("{}_{}", base, n);
  return id;
}

/// Graph of the sources without parents, for lookups by name and pattern.
Result<StructureGraph> graph_of_sources(std::span<const SourceStructure> sources,
                                        std::set<std::string>& taken) {
  std::vector<Structure> structures;
  for (const SourceStructure& source : sources) {
    Structure structure;
    structure.id = unique_id(source.name, taken);
    structure.name = source.name;
    structure.color = source.color.value_or(default_color(structures.size()));
    structure.label = source.label;
    structure.external = source.external;
    structures.push_back(std::move(structure));
  }
  return StructureGraph::build(std::move(structures));
}

/// Numbers structures by first mention in the tree and collects their parents.
class GraphBuilder {
 public:
  GraphBuilder(std::span<const SourceStructure> sources, StructureGraph flat, std::set<std::string> taken)
      : sources_(sources),
        flat_(std::move(flat)),
        taken_(std::move(taken)),
        index_of_source_(sources.size(), kNoStructure) {}

  /// Call first: a member may name a group that a later line defines.
  void collect_group_names(std::span<const TreeLine> lines) {
    for (const TreeLine& line : lines) {
      for (const std::string& group : line.groups) {
        if (!source_named(group)) group_names_.insert(to_lower(group));
      }
    }
  }

  Result<void> place(const TreeLine& line) {
    StructureIndex parent = kNoStructure;
    for (const std::string& name : line.groups) {
      const auto source = source_named(name);
      const StructureIndex group = source ? place_source(*source) : place_group(name);
      add_parent(group, parent);
      parent = group;
    }
    if (line.member.empty()) {
      if (line.color) structures_[parent].color = line.color->first;
      return {};
    }
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> members, find_members(line.member));
    for (std::size_t n = 0; n < members.size(); ++n) {
      add_parent(members[n], parent);
      if (line.color) structures_[members[n]].color = between(*line.color, n, members.size());
    }
    return {};
  }

  Result<PlacedStructures> finish() {
    for (std::size_t n = 0; n < sources_.size(); ++n) place_source(static_cast<StructureIndex>(n));
    SPLATLAS_ASSIGN_OR_RETURN(StructureGraph graph, StructureGraph::build(std::move(structures_)));
    return PlacedStructures{std::move(graph), std::move(index_of_source_)};
  }

 private:
  static Rgb between(const ColorRange& range, std::size_t n, std::size_t count) {
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
      const double t = count > 1 ? static_cast<double>(n) / static_cast<double>(count - 1) : 0.0;
      return static_cast<std::uint8_t>(a + (b - a) * t + 0.5);
    };
    return {mix(range.first.r, range.last.r), mix(range.first.g, range.last.g),
            mix(range.first.b, range.last.b)};
  }

  /// The source with this name or id, if unique. Nullopt for patterns.
  std::optional<StructureIndex> source_named(const std::string& name) const {
    if (name.find('*') != std::string::npos) return std::nullopt;
    const auto found = find_structures(flat_, name);
    if (!found || found->size() != 1) return std::nullopt;
    return found->front();
  }

  StructureIndex place_source(StructureIndex source) {
    StructureIndex& index = index_of_source_[source];
    if (index != kNoStructure) return index;
    index = static_cast<StructureIndex>(structures_.size());
    structures_.push_back(flat_[source]);
    return index;
  }

  StructureIndex place_group(const std::string& name) {
    const auto next = static_cast<StructureIndex>(structures_.size());
    const auto [entry, is_new] = groups_.emplace(to_lower(name), next);
    if (is_new) {
      Structure group;
      group.id = unique_id(name, taken_);
      group.name = name;
      group.color = default_color(next);
      structures_.push_back(std::move(group));
    }
    return entry->second;
  }

  void add_parent(StructureIndex child, StructureIndex parent) {
    std::vector<StructureIndex>& parents = structures_[child].parents;
    if (parent == kNoStructure || std::find(parents.begin(), parents.end(), parent) != parents.end()) return;
    parents.push_back(parent);
  }

  Result<std::vector<StructureIndex>> find_members(const std::string& member) {
    if (group_names_.contains(to_lower(member))) return std::vector{place_group(member)};
    std::vector<StructureIndex> found;
    const std::vector<std::string_view> conditions = split(member, '&');
    for (std::size_t n = 0; n < conditions.size(); ++n) {
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> fitting, find_sources(conditions[n]));
      if (n == 0) found = fitting;
      std::erase_if(found, [&](StructureIndex s) { return std::ranges::find(fitting, s) == fitting.end(); });
    }
    if (found.empty()) return fail(ErrorCode::kFailed, "no structure fits '{}'", member);
    for (StructureIndex& index : found) index = place_source(index);
    return found;
  }

  /// Sources that match a condition: sorted by code for "code:...", else in source order.
  [[nodiscard]] Result<std::vector<StructureIndex>> find_sources(std::string_view condition) const {
    constexpr std::string_view kCode = "code:";
    if (condition.starts_with(kCode)) return sources_with_codes(condition.substr(kCode.size()));
    SPLATLAS_ASSIGN_OR_RETURN(std::vector<StructureIndex> found, find_structures(flat_, condition));
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Sources with codes in a list such as "2001-2999,3001", sorted by code.
  Result<std::vector<StructureIndex>> sources_with_codes(std::string_view list) const {
    std::vector<std::pair<std::int64_t, StructureIndex>> found;
    for (const std::string_view range : split(list, ',')) {
      const std::size_t dash = range.find('-');
      const auto low = parse_integer(trimmed(range.substr(0, dash)));
      const auto high = dash == std::string_view::npos ? low : parse_integer(trimmed(range.substr(dash + 1)));
      if (!low || !high || *low > *high) {
        return fail(ErrorCode::kFailed, "'{}' is no code and no range of codes", range);
      }
      for (StructureIndex source = 0; source < sources_.size(); ++source) {
        const auto code = sources_[source].code;
        if (code && *code >= *low && *code <= *high) found.emplace_back(*code, source);
      }
    }
    if (found.empty()) {
      return fail(ErrorCode::kFailed, "no structure has a code in '{}' (codes come from --names)", list);
    }
    std::sort(found.begin(), found.end());
    std::vector<StructureIndex> indices;
    for (const auto& [code, source] : found) indices.push_back(source);
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    return indices;
  }

  std::span<const SourceStructure> sources_;
  StructureGraph flat_;  // the sources alone
  std::set<std::string> taken_;
  std::set<std::string> group_names_;
  std::vector<Structure> structures_;
  std::vector<StructureIndex> index_of_source_;
  std::map<std::string, StructureIndex> groups_;
};

}  // namespace

Result<PlacedStructures> build_graph(std::span<const SourceStructure> sources,
                                     std::span<const TreeLine> lines, const std::string& file) {
  std::set<std::string> taken;
  SPLATLAS_ASSIGN_OR_RETURN(StructureGraph flat, graph_of_sources(sources, taken));
  GraphBuilder builder(sources, std::move(flat), std::move(taken));
  builder.collect_group_names(lines);
  for (const TreeLine& line : lines) {
    if (const auto placed = builder.place(line); !placed) {
      return bad_file(file, "line {}: {}", line.number, placed.error().message);
    }
  }
  Result<PlacedStructures> placed = builder.finish();
  if (!placed) return bad_file(file, "{}", placed.error().message);
  return placed;
}

}  // namespace splatlas
