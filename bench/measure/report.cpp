#include "bench/measure/report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "player/render/sheets/splat/splat_kernels.h"

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

/// Title, aligned columns (numbers to the right) and notes.
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

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "gcc " __VERSION__;
#endif
}

nlohmann::ordered_json describe_machine() {
  const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  return {
      {"cpu", cpu_model()},
      {"cores", std::thread::hardware_concurrency()},
      {"simd", best_kernels().name},
      {"compiler", compiler()},
      {"build_type", SPLATLAS_BUILD_TYPE},
      {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(now)))}};
}

}  // namespace

void raise(nlohmann::ordered_json& summary, const std::string& key, double value) {
  if (!summary.contains(key) || summary[key].get<double>() < value) summary[key] = value;
}

void lower(nlohmann::ordered_json& summary, const std::string& key, double value) {
  if (!summary.contains(key) || summary[key].get<double>() > value) summary[key] = value;
}

std::string report_text(const Report& report) {
  std::string text;
  for (const Table& table : report.tables) text += to_text(table) + "\n";
  text += "summary\n";
  for (const auto& [key, value] : report.summary.items()) {
    text += value.is_number_float() ? fmt::format("  {:<28} {:.3f}\n", key, value.get<double>())
                                    : fmt::format("  {:<28} {}\n", key, value.dump());
  }
  text += "machine\n";
  const auto machine = describe_machine();
  for (const auto& [key, value] : machine.items()) {
    text += fmt::format("  {:<28} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text;
}

std::string report_json(const std::string& bench, const Report& report) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Table& table : report.tables) {
    for (const Row& row : table.rows) {
      rows.push_back({{"table", table.name}});
      rows.back().update(row);
    }
  }
  const nlohmann::ordered_json json{
      {"bench", bench}, {"machine", describe_machine()}, {"rows", rows}, {"summary", report.summary}};
  return json.dump(2) + "\n";
}

}  // namespace splatlas
