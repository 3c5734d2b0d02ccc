// splatlas-bench: benchmarks behind the published figures.

#include <algorithm>
#include <array>
#include <new>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/bench.h"
#include "format/io/memory_limit.h"
#include "format/io/output_file.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

struct Bench {
  const char* name;
  const char* shows;  ///< description for --help
  Result<Report> (*run)(const BenchOptions& options);
};
constexpr std::array kBenches{
    Bench{"phantom", "the paper's tables 1 and 2: the phantom's counts, and cost against full traversal",
          run_phantom_bench},
    Bench{"head", "the paper's tables 3 and 4 on the Colin 27 head: cost against full traversal",
          run_head_bench},
    Bench{"models",
          "one run model, one per level of the tree, octrees: memory, and the first frame of selections",
          run_models_bench},
    Bench{"scale", "1, 2, 4, 8 times the voxels around the same selection, and everything on finer grids",
          run_scale_bench},
    Bench{"size", "bytes of atlases, sections and single structures beside .nii.gz, Draco and crackle",
          run_size_bench},
    Bench{"build", "preprocessing: time by stage, over loading alone, memory", run_build_bench},
    Bench{"web", "frames by the WebAssembly module in Node beside native ones", run_web_bench},
    Bench{"error", "run time against error, ours at every quality beside VolPack and VTK", run_error_bench},
    Bench{"hybrid", "surfaces mixed with volume, beside VTK's depth peeling and FixedPoint with surfaces",
          run_hybrid_bench},
    Bench{"numerics", "bias, popping, ripple, threads, stress inputs, orders of convergence",
          run_numerics_bench},
    Bench{"limit", "samples composited against a dense SIMD kernel, two threads against one, traversal",
          run_limit_bench},
    Bench{"skip", "cost against what is selected; selections against atlases of nothing else",
          run_skip_bench},
    Bench{"select", "selection change to the first correct picture, beside VTK's FixedPoint and VolPack",
          run_select_bench},
};

int report_error(const Error& error) {
  print_error("splatlas-bench", error.message);
  return exit_status(error.code);
}

std::string names_and_what_they_show() {
  std::string text = "Benches:\n";
  for (const Bench& bench : kBenches) text += fmt::format("  {:<10} {}\n", bench.name, bench.shows);
  return text + "\nExit status: 0 done; 1 could not be done, or a check failed; 2 wrong usage.";
}

Result<void> run_bench(const std::string& name, const BenchOptions& options, const std::string& json) {
  const auto bench = std::ranges::find_if(kBenches, [&](const Bench& b) { return b.name == name; });
  if (bench == kBenches.end()) {
    return fail(ErrorCode::kUsage, fmt::format("{}: no such bench; --help lists them", name));
  }
  SPLATLAS_RETURN_IF_ERROR(
      check_outputs(std::vector<std::filesystem::path>{json}, std::vector{options.atlas}));
  if (!json.empty()) SPLATLAS_RETURN_IF_ERROR(check_writable_file(json));
  SPLATLAS_ASSIGN_OR_RETURN(const Report report, bench->run(options));
  SPLATLAS_RETURN_IF_ERROR(print_text(PrintableText::of_layout(report_text(report))));
  if (!json.empty()) {
    const std::string text = report_json(name, report);
    SPLATLAS_RETURN_IF_ERROR(write_file(json, std::as_bytes(std::span(text))));
  }
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
  } catch (const CLI::Success& help) {
    std::ostringstream text;
    app.exit(help, text);
    const Result<void> shown = print_text(PrintableText::of_layout(text.str()));
    return shown ? 0 : report_error(shown.error());
  } catch (const CLI::ParseError& error) {
    return report_error({ErrorCode::kUsage, fmt::format("{}; see splatlas-bench --help", error.what())});
  }
  if (app.count("--json") > 0 && json.empty()) {
    return report_error({ErrorCode::kUsage, "--json \"\": must name a file"});
  }
  install_interrupt_handlers();
  options.tell = [](const std::string& what) { print_error("splatlas-bench", what); };
  const Result<void> result = run_bench(name, options, json);
  return result ? 0 : report_error(result.error());
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try { return splatlas::run(argc, argv); } catch (const std::bad_alloc&) {
  splatlas::print_error("splatlas-bench", std::string("out of memory; ") + splatlas::kOutOfMemoryRemedy);
  return 1;
} catch (const std::exception& exception) {
  splatlas::print_error("splatlas-bench", exception.what());
  return 1;
}
