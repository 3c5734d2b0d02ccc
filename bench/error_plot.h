// Run time against error, as a picture.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "bench/table.h"
#include "format/result.h"

namespace splatlas {

/// The gnuplot script: one panel per scene (columns) and look (rows) at the smallest size, both axes
/// logarithmic; one curve per renderer through its settings, ours with two threads. Rows are those of the
/// `error` bench.
[[nodiscard]] std::string error_plot_script(std::span<const Table> tables, const std::filesystem::path& png);

/// Runs it through gnuplot (Debian's package gnuplot-nox). kFailed when there is none, or it cannot write the
/// file; then no file is left behind.
[[nodiscard]] Result<void> write_error_plot(std::span<const Table> tables, const std::filesystem::path& png);

}  // namespace splatlas
