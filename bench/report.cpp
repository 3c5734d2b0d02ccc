#include "bench/report.h"

#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/machine.h"

namespace splatlas {

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

Result<void> write_report(const std::filesystem::path& path, const std::string& json) {
  std::filesystem::path partial = path;
  partial += fmt::format(".{}.part", getpid());
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file << json;
  file.close();
  std::error_code error;
  if (!file.fail()) std::filesystem::rename(partial, path, error);
  if (file.fail() || error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written", path.string()));
  }
  return {};
}

}  // namespace splatlas
