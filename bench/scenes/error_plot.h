// Plot of run time against error.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "bench/measure/report.h"
#include "format/result.h"

namespace splatlas {

/// The gnuplot script: one panel per scene (columns) and transfer function (rows) at the smallest size, with
/// logarithmic axes; one curve per renderer through its settings, ours with two threads. `tables` come from
/// the bench `error`.
[[nodiscard]] std::string error_plot_script(std::span<const Table> tables, const std::filesystem::path& png);

/// Runs the script through gnuplot (Debian package gnuplot-nox). kFailed without gnuplot, or if it cannot
/// write the file; leaves no partial file.
[[nodiscard]] Result<void> write_error_plot(std::span<const Table> tables, const std::filesystem::path& png);

}  // namespace splatlas
