#include "bench/report.h"

#include <fmt/format.h>

#include "bench/machine.h"

namespace splatlas {

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
