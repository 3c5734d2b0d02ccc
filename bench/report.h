// Report of a bench.
#pragma once

#include <string>
#include <vector>

#include "bench/table.h"

namespace splatlas {

struct Report {
  std::vector<Table> tables;
  nlohmann::ordered_json summary = nlohmann::ordered_json::object();  ///< KEY: number, with documented keys
  /// Failed checks (pictures that differ, counts unlike those of the paper), one line each. Tables are
  /// printed all the same; the exit status is 1.
  std::vector<std::string> failures;
};

/// Sets a number of the summary to `value` if it is missing or lower.
void raise(nlohmann::ordered_json& summary, const std::string& key, double value);

/// Sets a number of the summary to `value` if it is missing or higher.
void lower(nlohmann::ordered_json& summary, const std::string& key, double value);

/// The tables and the summary, with the machine.
[[nodiscard]] std::string report_text(const Report& report);

/// {"bench", "machine", "rows", "summary"}: the rows of all tables, each with the name of its table.
[[nodiscard]] std::string report_json(const std::string& bench, const Report& report);

}  // namespace splatlas
