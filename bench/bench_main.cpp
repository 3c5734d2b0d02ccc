// splatlas-bench: the tables that the project's claims stand on.

#include <algorithm>
#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/bench.h"

namespace splatlas {
namespace {

int report_error(const Error& error) {
  fmt::print(stderr, "splatlas-bench: {}\n", error.message);
  return exit_status(error.code);
}

std::string names_and_what_they_show() {
  std::string text = "Benches:\n";
  for (const Bench& bench : benches()) text += fmt::format("  {:<10} {}\n", bench.name, bench.shows);
  return text + "\nExit status: 0 done; 1 could not be done, or a check failed; 2 wrong usage.";
}

Result<void> run_bench(const std::string& name, const BenchOptions& options, const std::string& json) {
  const auto list = benches();
  const auto bench = std::find_if(list.begin(), list.end(), [&](const Bench& b) { return b.name == name; });
  if (bench == list.end()) {
    return fail(ErrorCode::kUsage, fmt::format("{}: no such bench; --help lists them", name));
  }
  SPLATLAS_ASSIGN_OR_RETURN(const Report report, bench->run(options));
  fmt::print("{}", report_text(report));
  if (!json.empty()) SPLATLAS_RETURN_IF_ERROR(write_report(json, report_json(name, report)));
  if (report.failures.empty()) return {};
  std::string failures = fmt::format("{}: ", name);
  for (const std::string& failure : report.failures) failures += failure + "; ";
  return fail(ErrorCode::kFailed, failures.substr(0, failures.size() - 2));
}

int run(int argc, char** argv) {
  CLI::App app{"Measures Splatlas and prints a table", "splatlas-bench"};
  std::string name, json;
  BenchOptions options;
  app.add_option("NAME", name, "which bench")->required();
  app.add_option("--json", json, "write machine, rows and summary to this file as well");
  app.add_option("--atlas", options.atlas, "draw this atlas instead of building one");
  app.add_option("--plot", options.plot, "error: draw time against error into this PNG");
  app.add_flag("--quick", options.quick, "fewer frames and repeats; counts are the same");
  app.footer(names_and_what_they_show());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_status(ErrorCode::kUsage);
  }
  options.tell = [](const std::string& what) { fmt::print(stderr, "splatlas-bench: {}\n", what); };
  const Result<void> result = run_bench(name, options, json);
  return result ? 0 : report_error(result.error());
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  return splatlas::run(argc, argv);
} catch (const std::exception& exception) {
  fmt::print(stderr, "splatlas-bench: {}\n", exception.what());
  return 1;
}
