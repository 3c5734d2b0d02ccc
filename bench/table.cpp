#include "bench/table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace splatlas {
namespace {

std::string cell_text(const Row& cell) {
  if (cell.is_null()) return "-";
  if (cell.is_string()) return cell.get<std::string>();
  if (!cell.is_number_float()) return cell.dump();
  const auto value = cell.get<double>();
  if (std::abs(value) >= 1000) return fmt::format("{:.0f}", value);
  if (std::abs(value) >= 100) return fmt::format("{:.1f}", value);
  if (std::abs(value) >= 10) return fmt::format("{:.2f}", value);
  return fmt::format("{:.3f}", value);
}

std::vector<std::string> column_names(const Table& table) {
  std::vector<std::string> names;
  for (const Row& row : table.rows) {
    for (const auto& [key, cell] : row.items()) {
      if (std::find(names.begin(), names.end(), key) == names.end()) names.push_back(key);
    }
  }
  return names;
}

/// Heading and cells of one column, padded to equal width.
std::vector<std::string> column_cells(const Table& table, const std::string& name) {
  std::vector<std::string> cells{name};
  bool words = true;
  for (const Row& row : table.rows) {
    const bool present = row.contains(name) && !row[name].is_null();
    cells.push_back(present ? cell_text(row[name]) : "-");
    words = words && (!present || row[name].is_string());
  }
  std::size_t width = 0;
  for (const std::string& cell : cells) width = std::max(width, cell.size());
  for (std::string& cell : cells) {
    cell = words ? fmt::format("{:<{}}", cell, width) : fmt::format("{:>{}}", cell, width);
  }
  return cells;
}

}  // namespace

std::string to_text(const Table& table) {
  std::vector<std::string> lines(table.rows.size() + 1);
  for (const std::string& name : column_names(table)) {
    const std::vector<std::string> cells = column_cells(table, name);
    for (std::size_t n = 0; n < lines.size(); ++n) lines[n] += "  " + cells[n];
  }
  std::string text = table.title + "\n";
  for (const std::string& line : lines) text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  for (const std::string& note : table.notes) text += "  " + note + "\n";
  return text;
}

}  // namespace splatlas
