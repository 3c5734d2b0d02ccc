// Report of a bench: tables, summary and machine, as text and JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace splatlas {

/// One row: named cells in column order; numbers, strings, or null for empty cells.
using Row = nlohmann::ordered_json;

/// A table. Columns are the keys of the rows, in order of first occurrence.
struct Table {
  std::string name;                     ///< short; in JSON every row carries it as "table"
  std::string title;                    ///< subject of the table
  std::vector<std::string> notes = {};  ///< lines below it, in text only
  std::vector<Row> rows = {};
};

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

/// {"bench", "machine", "rows", "summary"}: the rows of all tables, each with the name of its table. The
/// machine is {"cpu", "cores", "simd" (the selected kernels), "compiler", "build_type", "date" (UTC)}.
[[nodiscard]] std::string report_json(const std::string& bench, const Report& report);

}  // namespace splatlas
