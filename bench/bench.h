// Interface of benches, one file each, registered in bench_main.cpp.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "bench/measure/report.h"
#include "format/result.h"

namespace splatlas {

struct BenchOptions {
  bool quick = false;           ///< fewer frames and repeats; counts are the same
  std::filesystem::path atlas;  ///< used instead of building one; empty: build
  std::filesystem::path plot;   ///< output PNG of time against error (bench error); empty: none
  std::function<void(const std::string&)> tell = [](const std::string&) {};  ///< reports progress
};

/// A selection to measure.
struct BenchScene {
  const char* name;
  const char* selection;  ///< selection text
  const char* cuts = "";  ///< of parse_cuts()
};

/// Of the bench `scale`: first pictures and steady drafts of a CT as large as a clinic's, at the budget of
/// the window, and the growth of steady frames with the voxels. Without the CT: tells so, and adds nothing.
[[nodiscard]] Result<void> add_clinic(const BenchOptions& options, Report& report);

[[nodiscard]] Result<Report> run_phantom_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_head_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_models_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_scale_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_size_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_build_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_web_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_error_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_hybrid_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_numerics_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_limit_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_skip_bench(const BenchOptions& options);
[[nodiscard]] Result<Report> run_select_bench(const BenchOptions& options);

}  // namespace splatlas
