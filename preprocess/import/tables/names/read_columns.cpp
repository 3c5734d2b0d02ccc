// Tables with named columns, separated by commas, semicolons or tabs; also rows "label,name" without header;
// and FSL's atlases in XML.
#include <algorithm>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/quiet_vtk.h"
#include "preprocess/import/tables/names_collector.h"
#include "preprocess/import/tables/table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// True for a first row such as "1,spleen": it is no header.
bool is_row(const std::vector<std::string>& header) {
  const auto is_label = [](const std::string& field) { return parse_label(field).has_value(); };
  return header.size() > 1 && (is_label(header.front()) || is_label(header.back())) &&
         !std::ranges::all_of(header,
                              [](const std::string& field) { return parse_number(field).has_value(); });
}

bool recognise_csv(std::string_view head) {
  const auto separator = find_separator(head);
  if (!separator) return false;
  const std::vector<TextLine> lines = lines_of(head);
  const Table table = parse_table(lines.front().text, *separator);
  if (is_row(table.columns)) return *separator != '\t';  // else a list of labels and names
  if (parse_integer(split_blanks(lines.front().text).front())) return false;  // "7 lobe, label"
  const std::vector<Column> by_name = columns_of(table), columns = columns_of(parse_table(head, *separator));
  return has_column(by_name, ColumnRole::kLabel) || has_column(by_name, ColumnRole::kKey) ||
         has_column(by_name, ColumnRole::kName) ||
         (has_column(columns, ColumnRole::kLabel) && has_column(columns, ColumnRole::kName));
}

Result<void> read_csv(const NamesInput& input, NamesCollector& into) {
  const auto separator = find_separator(input.text);
  if (!separator)
    return input.refuse("line 1: holds no comma, semicolon or tab; give another --names-format");
  Table table = parse_table(input.text, *separator);
  if (is_row(table.columns)) add_header(table);
  return add_table(table, input, into);
}

/// BIDS: _dseg.tsv with the columns index and name, in tabs.
bool recognise_bids(std::string_view head) {
  const std::vector<TextLine> lines = lines_of(head);
  if (lines.empty()) return false;
  const std::vector<std::string> columns = parse_table(lines.front().text, '\t').columns;
  return std::ranges::count(columns, "index") == 1 && std::ranges::count(columns, "name") == 1;
}

// FSL's atlases: <label index="0" x="1" y="2" z="3">name</label>. Indices of probabilistic ones count maps
// from 0; their label map counts from 1. Julich's: <Structure grayvalue="1">name</Structure>.

Result<void> read_fsl(const NamesInput& input, NamesCollector& into) {
  const auto atlas = parse_xml(input.text);
  vtkXMLDataElement* data = nullptr;
  for (const char* const list : {"data", "Structures"})
    if (atlas != nullptr && data == nullptr) data = atlas->FindNestedElementWithName(list);
  if (data == nullptr) {
    return input.refuse("is no whole XML with labels in its <data> or <Structures>; get the file again");
  }
  const bool counts_maps = to_lower(input.text).find("<type>prob") != std::string::npos;
  for (int n = 0; n < data->GetNumberOfNestedElements(); ++n) {
    vtkXMLDataElement* const label = data->GetNestedElement(n);
    LabelName name;
    name.line = static_cast<std::size_t>(n) + 1;
    name.name = text_of(label);
    if (const auto value = parse_label(attribute(*label, "index") + attribute(*label, "grayvalue"))) {
      into.add(fmt::to_string(*value + (counts_maps ? 1 : 0)), std::move(name));
    } else {
      into.add_fault(name.line, fmt::format("{} has no index", in_quotes(name.name)));
    }
  }
  return {};
}

}  // namespace

const Dialect kCsvNames{
    {NamesFormat::kCsv, "csv", "table with columns (CSV or TSV)"}, recognise_csv, read_csv};
const Dialect kBidsNames{{NamesFormat::kBids, "bids", "BIDS segmentation table"}, recognise_bids, read_csv};
const Dialect kFslNames{{NamesFormat::kFsl, "fsl", "FSL atlas"},
                        [](std::string_view head) {
                          const auto has = [&](const char* text) { return head.find(text) != head.npos; };
                          return (has("<atlas") && has("<label")) || (has("<Structure ") && has("grayvalue"));
                        },
                        read_fsl};

}  // namespace splatlas
