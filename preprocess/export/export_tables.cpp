#include "preprocess/export/export_tables.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "format/text/json_text.h"
#include "preprocess/import/tables/table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// A field of CSV (RFC 4180).
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted;
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return fmt::format("\"{}\"", quoted);
}

std::string with_underscores(std::string name) {
  std::ranges::replace(name, ' ', '_');
  return name;
}

/// Structures with voxels of their own in a source: labelled ones, sorted by label.
std::vector<const Structure*> labelled(const StructureGraph& graph) {
  std::vector<const Structure*> result;
  for (const Structure& structure : graph.structures()) {
    if (structure.label) result.push_back(&structure);
  }
  std::ranges::sort(result, {}, [](const Structure* s) { return *s->label; });
  return result;
}

/// The name of a column that readers take for this vocabulary.
std::string column_name(const std::string& vocabulary) {
  for (const std::string& name : {vocabulary, "name_" + vocabulary}) {
    const Column column = column_of(name);
    if (column.role == ColumnRole::kSynonym ||
        (column.role == ColumnRole::kTerm && column.vocabulary == vocabulary))
      return name;
  }
  return "term " + vocabulary;
}

/// label, name, color, id, and a column per vocabulary. Several terms of one vocabulary are joined by ";".
Result<std::string> csv_text(const StructureGraph& graph) {
  std::string text = "label,name,color,id";
  std::map<std::string, std::size_t> columns;  // by vocabulary
  for (const Structure& structure : graph.structures()) {
    for (const Term& term : structure.terms) {
      if (columns.emplace(term.vocabulary, columns.size()).second)
        text += fmt::format(",{}", csv_field(column_name(term.vocabulary)));
    }
  }
  text += "\n";
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    const Structure& structure = graph[s];
    if (!structure.label && (structure.external || !graph.children(s).empty())) continue;
    text += fmt::format("{},{},{},{}", structure.label ? fmt::to_string(*structure.label) : "",
                        csv_field(structure.name), to_hex(structure.color), csv_field(structure.id));
    std::vector<std::string> values(columns.size());
    for (const Term& term : structure.terms) {
      std::string& value = values[columns.at(term.vocabulary)];
      value += (value.empty() ? "" : ";") + term.value;
    }
    for (const std::string& value : values) text.append(",").append(csv_field(value));
    text += "\n";
    if (text.size() > kMaxTextBytes)
      return fail(ErrorCode::kLimit,
                  "{} vocabularies of {} structures take more than {} bytes, the limit of a table that "
                  "is read; choose a --names-format without vocabularies, such as bids",
                  columns.size(), graph.size(), kMaxTextBytes);
  }
  return text;
}

std::string niivue_text(const StructureGraph& graph) {
  nlohmann::ordered_json json{{"R", {0}}, {"G", {0}}, {"B", {0}},
                              {"A", {0}}, {"I", {0}}, {"labels", {"background"}}};
  for (const Structure* s : labelled(graph)) {
    json["R"].push_back(s->color.r);
    json["G"].push_back(s->color.g);
    json["B"].push_back(s->color.b);
    json["A"].push_back(255);
    json["I"].push_back(*s->label);
    json["labels"].push_back(s->name);
  }
  return json_text(json, -1);
}

/// A line per labelled structure.
template <typename Line>
std::string lines_text(const StructureGraph& graph, std::string text, const Line& line) {
  for (const Structure* structure : labelled(graph)) text += line(*structure) + "\n";
  return text;
}

/// Names in a tree file that a reader takes for a structure with this name.
class TreeNames {
 public:
  explicit TreeNames(const StructureGraph& graph) : graph_(graph) {
    for (const Structure& structure : graph.structures()) {
      ++uses_[name_key(structure.name)];
      ++uses_[name_key(structure.id)];
    }
  }
  [[nodiscard]] std::string of(StructureIndex s) const {
    const Structure& structure = graph_[s];
    const std::size_t own = name_key(structure.name) == name_key(structure.id) ? 2 : 1;
    const bool is_plain = structure.name.find_first_of("/*&#") == std::string::npos &&
                          structure.name.find(" color=") == std::string::npos &&
                          !structure.name.starts_with("code:");
    return is_plain && uses_.at(name_key(structure.name)) == own ? structure.name : structure.id;
  }
  /// Groups are known by their path: their names may repeat.
  [[nodiscard]] std::string of_group(StructureIndex s) const {
    const std::string& name = graph_[s].name;
    return name.find_first_of("/*&#") == std::string::npos ? name : graph_[s].id;
  }

 private:
  const StructureGraph& graph_;
  std::map<std::string, std::size_t> uses_;
};

}  // namespace

Result<std::string> names_text(const StructureGraph& graph, NamesFormat format) {
  const bool needs_labels = format != NamesFormat::kCsv;
  if (needs_labels && labelled(graph).empty())
    return fail(ErrorCode::kFailed,
                "--names-format: no structure has a label; only csv holds names without labels");
  const auto rgb = [](const Structure& s, char separator) {
    return fmt::format("{0}{3}{1}{3}{2}", s.color.r, s.color.g, s.color.b, separator);
  };
  switch (format) {
    case NamesFormat::kCsv: return csv_text(graph);
    case NamesFormat::kNiivue: return niivue_text(graph);
    case NamesFormat::kItkSnap:
      return lines_text(graph, "0 0 0 0 0 0 0 \"Clear Label\"\n", [&](const Structure& s) {
        std::string name = s.name;
        std::ranges::replace(name, '"', '\'');
        return fmt::format("{} {} 1 1 1 \"{}\"", *s.label, rgb(s, ' '), name);
      });
    case NamesFormat::kCtbl:
      return lines_text(graph, "# Color table file\n0 background 0 0 0 0\n", [&](const Structure& s) {
        return fmt::format("{} {} {} 255", *s.label, with_underscores(s.name), rgb(s, ' '));
      });
    case NamesFormat::kFreeSurfer:
      return lines_text(graph, "#No. Label Name: R G B A\n0 Unknown 0 0 0 0\n", [&](const Structure& s) {
        return fmt::format("{} {} {} 0", *s.label, with_underscores(s.name), rgb(s, ' '));
      });
    case NamesFormat::kBids:
      return lines_text(graph, "index\tname\tcolor\n", [&](const Structure& s) {
        return fmt::format("{}\t{}\t{}", *s.label, s.name, to_hex(s.color));
      });
    case NamesFormat::kMricron:
      return lines_text(graph, "", [&](const Structure& s) {
        const bool has_blank = s.name.find(' ') != std::string::npos;
        return fmt::format("{} {}", *s.label, has_blank ? fmt::format("\"{}\"", s.name) : s.name);
      });
    default:
      return fail(
          ErrorCode::kUsage,
          "--names-format: names are written as csv, itksnap, ctbl, freesurfer, bids, mricron or niivue");
  }
}

std::string losses_of(const StructureGraph& graph, NamesFormat format) {
  std::string colors = format == NamesFormat::kMricron ? "colours" : "";
  const bool has_terms =
      std::ranges::any_of(labelled(graph), [](const Structure* s) { return !s->terms.empty(); });
  if (format == NamesFormat::kCsv || !has_terms) return colors;
  return colors + (colors.empty() ? "" : ", ") + "synonyms, languages and codes";
}

Result<std::string> tree_text(const StructureGraph& graph) {
  const TreeNames names(graph);
  // Count paths and their bytes first; infinite if they are too many for a double
  std::vector<double> paths(graph.size()), bytes(graph.size());
  double all_paths = 0, all_bytes = 0;
  for (const StructureIndex s : graph.topological()) {
    paths[s] = graph[s].parents.empty() ? 1 : 0;
    for (const StructureIndex parent : graph[s].parents) {
      paths[s] += paths[parent];
      bytes[s] += bytes[parent];
    }
    const bool is_group = !graph.children(s).empty();
    bytes[s] += paths[s] * static_cast<double>(is_group ? names.of_group(s).size() + 1 : names.of(s).size());
    constexpr std::size_t kRestOfLine = std::string_view(" color=#rrggbb\n").size();
    all_paths += paths[s];
    all_bytes += bytes[s] + paths[s] * kRestOfLine;
  }
  if (all_bytes > kMaxTextBytes) {
    return fail(ErrorCode::kLimit,
                "{:.4g} paths of {} structures take {:.4g} bytes, and a tree file has at most {}; leave "
                "out --tree",
                all_paths, graph.size(), all_bytes, kMaxTextBytes);
  }
  std::string text;
  // Depth first; a structure has a line under each of its parents.
  const auto add = [&](const auto& add_below, StructureIndex s, const std::string& above) -> void {
    const bool is_group = !graph.children(s).empty();
    const std::string path = above + (is_group ? names.of_group(s) + "/" : names.of(s));
    text += fmt::format("{} color={}\n", path, to_hex(graph[s].color));
    for (const StructureIndex child : graph.children(s)) add_below(add_below, child, path);
  };
  for (const StructureIndex root : graph.roots()) add(add, root, "");
  return text;
}

}  // namespace splatlas
