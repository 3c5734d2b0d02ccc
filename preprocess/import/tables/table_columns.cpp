#include "preprocess/import/tables/table_columns.h"

#include <algorithm>
#include <array>
#include <optional>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

struct Alias {
  const char* name;
  ColumnRole role;
  const char* vocabulary = "";
};

/// Of several columns of one role, the alias that stands first counts.
constexpr Alias kAliases[] = {
    {"labelvalue", ColumnRole::kLabel},
    {"label_value", ColumnRole::kLabel},
    {"label", ColumnRole::kLabel},
    {"labels", ColumnRole::kLabel},
    {"index", ColumnRole::kLabel},
    {"idx", ColumnRole::kLabel},
    {"value", ColumnRole::kLabel},
    {"label_id", ColumnRole::kLabel},
    {"labelid", ColumnRole::kLabel},
    {"label_number", ColumnRole::kLabel},
    {"number", ColumnRole::kLabel},
    {"class", ColumnRole::kLabel},
    {"class_id", ColumnRole::kLabel},
    {"no", ColumnRole::kLabel},
    {"nr", ColumnRole::kLabel},
    {"id", ColumnRole::kKey},
    {"key", ColumnRole::kKey},
    {"structure_id", ColumnRole::kKey},
    {"region_id", ColumnRole::kKey},
    {"roi_id", ColumnRole::kKey},
    {"name", ColumnRole::kName},
    {"structure", ColumnRole::kName},
    {"region", ColumnRole::kName},
    {"labelname", ColumnRole::kName},
    {"label_name", ColumnRole::kName},
    {"structure_name", ColumnRole::kName},
    {"region_name", ColumnRole::kName},
    {"roi", ColumnRole::kName},
    {"roi_name", ColumnRole::kName},
    {"class_name", ColumnRole::kName},
    {"full_name", ColumnRole::kName},
    {"totalsegmentator_name", ColumnRole::kName},
    {"color", ColumnRole::kColor},
    {"colour", ColumnRole::kColor},
    {"hex", ColumnRole::kColor},
    {"rgb", ColumnRole::kColor},
    {"rgba", ColumnRole::kColor},
    {"color_hex", ColumnRole::kColor},
    {"hex_color", ColumnRole::kColor},
    {"color_hex_triplet", ColumnRole::kColor},
    {"rgb_triplet", ColumnRole::kColor},
    {"dicomrgbcolor", ColumnRole::kColor},
    {"r", ColumnRole::kRed},
    {"red", ColumnRole::kRed},
    {"color_r", ColumnRole::kRed},
    {"g", ColumnRole::kGreen},
    {"green", ColumnRole::kGreen},
    {"color_g", ColumnRole::kGreen},
    {"b", ColumnRole::kBlue},
    {"blue", ColumnRole::kBlue},
    {"color_b", ColumnRole::kBlue},
    {"parent", ColumnRole::kParent},
    {"parent_id", ColumnRole::kParent},
    {"parent_structure_id", ColumnRole::kParent},
    {"parent_name", ColumnRole::kParent},
    {"parent_label", ColumnRole::kParent},
    {"path", ColumnRole::kPath},
    {"structure_id_path", ColumnRole::kPath},
    {"hierarchy", ColumnRole::kPath},
    {"synonym", ColumnRole::kSynonym},
    {"synonyms", ColumnRole::kSynonym},
    {"alias", ColumnRole::kSynonym},
    {"aliases", ColumnRole::kSynonym},
    {"alternative_name", ColumnRole::kSynonym},
    {"abbreviation", ColumnRole::kTerm, "abbreviation"},
    {"abbr", ColumnRole::kTerm, "abbreviation"},
    {"acronym", ColumnRole::kTerm, "abbreviation"},
    {"latin", ColumnRole::kTerm, "la"},
    {"snomed", ColumnRole::kTerm, "SNOMED"},
    {"snomedct", ColumnRole::kTerm, "SNOMED"},
    {"snomed_ct", ColumnRole::kTerm, "SNOMED"},
    {"sct", ColumnRole::kTerm, "SNOMED"},
    {"fma", ColumnRole::kTerm, "FMA"},
    {"radlex", ColumnRole::kTerm, "RadLex"},
    {"rid", ColumnRole::kTerm, "RadLex"},
    {"ta2", ColumnRole::kTerm, "TA2"},
    {"ta98", ColumnRole::kTerm, "TA98"},
    {"uberon", ColumnRole::kTerm, "UBERON"},
    {"neuronames", ColumnRole::kTerm, "NeuroNames"},
    {"a", ColumnRole::kUnused},
    {"alpha", ColumnRole::kUnused},
    {"color_a", ColumnRole::kUnused},
    {"vis", ColumnRole::kUnused},
    {"msh", ColumnRole::kUnused},
    {"visible", ColumnRole::kUnused},
};

/// Sequences of codes, in 3D Slicer's tables and by their names in DICOM.
constexpr std::array<std::array<const char*, 2>, 10> kSequences{{
    {"category", "category"},
    {"type", ""},
    {"typemodifier", "modifier"},
    {"region", "region"},
    {"regionmodifier", "region modifier"},
    {"segmentedpropertycategorycodesequence", "category"},
    {"segmentedpropertytypecodesequence", ""},
    {"segmentedpropertytypemodifiercodesequence", "modifier"},
    {"anatomicregionsequence", "region"},
    {"anatomicregionmodifiersequence", "region modifier"},
}};

std::string plain_name(std::string_view name) {
  std::string plain = to_lower(trimmed(name));
  std::ranges::replace_if(
      plain, [](char c) { return c == ' ' || c == '-' || c == '.' || c == ':'; }, '_');
  return plain;
}

const Alias* find_alias(std::string_view plain) {
  const auto* found =
      std::ranges::find(kAliases, plain, [](const Alias& a) { return std::string_view(a.name); });
  return found == std::end(kAliases) ? nullptr : found;
}

/// "type_codevalue" and the like.
std::optional<Column> column_of_code(std::string_view plain) {
  const std::size_t dash = plain.find('_');
  if (dash == std::string_view::npos) return std::nullopt;
  for (const auto& [sequence, vocabulary] : kSequences) {
    if (plain.substr(0, dash) != sequence) continue;
    const std::string_view part = plain.substr(dash + 1);
    if (part == "codingscheme" || part == "codingschemedesignator")
      return Column{ColumnRole::kScheme, vocabulary};
    if (part == "codevalue") return Column{ColumnRole::kSchemeCode, vocabulary};
    if (part == "codemeaning") return Column{ColumnRole::kUnused, {}};
  }
  return std::nullopt;
}

/// "name_de": a name in another language.
std::optional<Column> column_of_language(std::string_view plain) {
  for (const std::string_view prefix : {"name_", "label_", "structure_"}) {
    if (!plain.starts_with(prefix)) continue;
    const std::string_view language = plain.substr(prefix.size());
    const bool are_letters = std::ranges::all_of(language, [](char c) { return c >= 'a' && c <= 'z'; });
    if (language.size() == 2 && are_letters && language != "id" && language != "no")
      return Column{ColumnRole::kTerm, std::string(language)};
  }
  return std::nullopt;
}

bool has_labels(const Table& table, std::size_t column) {
  for (const Table::Row& row : table.rows) {
    if (column < row.fields.size() && !row.fields[column].empty())
      return parse_number(row.fields[column]).has_value();
  }
  return true;
}

}  // namespace

Column column_of(std::string_view name) {
  const std::string plain = plain_name(name);
  if (const Alias* alias = find_alias(plain)) return {alias->role, alias->vocabulary};
  if (const auto code = column_of_code(plain)) return *code;
  if (const auto language = column_of_language(plain)) return *language;
  for (const std::string_view suffix : {"_id", "_code", "id"}) {  // "FMA ID", "snomed_code"
    if (!plain.ends_with(suffix)) continue;
    const Alias* alias = find_alias(plain.substr(0, plain.size() - suffix.size()));
    if (alias != nullptr && alias->role == ColumnRole::kTerm) return {alias->role, alias->vocabulary};
  }
  constexpr std::string_view kTermPrefix = "term ";  // "term 99XYZ": any other vocabulary
  if (to_lower(name).starts_with(kTermPrefix))
    return {ColumnRole::kTerm, std::string(name.substr(kTermPrefix.size()))};
  return {};
}

std::size_t find_column(std::span<const Column> columns, ColumnRole role) {
  const auto found = std::ranges::find(columns, role, &Column::role);
  return found == columns.end() ? std::string::npos : static_cast<std::size_t>(found - columns.begin());
}

std::vector<Column> columns_of(const Table& table) {
  std::vector<Column> columns;
  for (const std::string& name : table.columns) columns.push_back(column_of(name));
  if (find_column(columns, ColumnRole::kName) == std::string::npos) {  // "index,label": the label is a name
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (columns[n].role == ColumnRole::kLabel && !has_labels(table, n)) columns[n].role = ColumnRole::kName;
    }
  }
  // One column for each role: the alias that stands first in the list.
  for (int role = static_cast<int>(ColumnRole::kLabel); role <= static_cast<int>(ColumnRole::kPath); ++role) {
    std::size_t best = std::string::npos;
    const auto rank = [&](std::size_t n) { return find_alias(plain_name(table.columns[n])); };
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (static_cast<int>(columns[n].role) != role) continue;
      if (best == std::string::npos || rank(n) < rank(best)) best = n;
    }
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (static_cast<int>(columns[n].role) == role && n != best) columns[n].role = ColumnRole::kUnknown;
    }
  }
  return columns;
}

}  // namespace splatlas
