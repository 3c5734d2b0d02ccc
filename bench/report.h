// What a bench hands back.
#pragma once

#include <string>
#include <vector>

#include "bench/table.h"

namespace splatlas {

struct Report {
  std::vector<Table> tables;
  nlohmann::ordered_json summary = nlohmann::ordered_json::object();  ///< KEY: number, the contract's keys
  /// What was found wrong (pictures that differ, counts that are not the paper's), one line each. The tables
  /// are shown all the same, and the program ends with exit status 1.
  std::vector<std::string> failures;
};

/// Sets a number of the summary to `value` where it has none yet, or a lower one.
void raise(nlohmann::ordered_json& summary, const std::string& key, double value);

/// The same to `value` where it has none yet, or a higher one.
void lower(nlohmann::ordered_json& summary, const std::string& key, double value);

/// The tables and the summary, with the machine.
[[nodiscard]] std::string report_text(const Report& report);

/// {"bench", "machine", "rows", "summary"}: the rows of all tables, each with its table's name.
[[nodiscard]] std::string report_json(const std::string& bench, const Report& report);

}  // namespace splatlas
