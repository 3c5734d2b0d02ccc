#include "bench/scenes/error_plot.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

namespace splatlas {
namespace {

/// Appends a new value, in order of first occurrence.
void note(std::vector<std::string>& values, const std::string& value) {
  if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

struct Contents {
  std::vector<std::string> scenes, appearances, renderers;
  int size = 0;  ///< smallest size
  std::vector<const Row*> rows;
};

Contents contents_of(std::span<const Table> tables) {
  Contents contents;
  for (const Table& table : tables) {
    for (const Row& row : table.rows) {
      const int size = row["size"].get<int>();
      contents.size = contents.size == 0 ? size : std::min(size, contents.size);
      note(contents.scenes, row["scene"].get<std::string>());
      note(contents.appearances, row["transfer"].get<std::string>());
      note(contents.renderers, row["renderer"].get<std::string>());
      contents.rows.push_back(&row);
    }
  }
  return contents;
}

/// Points of a curve, fastest first.
std::string points_of(const Contents& contents, const std::string& scene, const std::string& appearance,
                      const std::string& renderer) {
  std::vector<std::pair<double, double>> points;
  for (const Row* row : contents.rows) {
    const Row& cell = *row;
    const bool ours_on_one_thread = renderer.starts_with("splatlas") && cell["threads"] == 1;
    if (cell["scene"] != scene || cell["transfer"] != appearance || cell["renderer"] != renderer ||
        cell["size"] != contents.size || ours_on_one_thread) {
      continue;
    }
    points.emplace_back(cell["wall_ms"].get<double>(), cell["rmse"].get<double>());
  }
  std::sort(points.begin(), points.end());
  std::string text;
  for (const auto& [wall_ms, rmse] : points) text += fmt::format("{} {}\n", wall_ms, rmse);
  return text;
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

}  // namespace

std::string error_plot_script(std::span<const Table> tables, const std::filesystem::path& png) {
  const Contents contents = contents_of(tables);
  std::string script = fmt::format(
      "set terminal pngcairo size {},{} noenhanced font 'DejaVu Sans,10'\n"
      "set output {}\n"
      "set logscale xy\nset grid\nset xlabel 'wall clock, ms'\nset ylabel 'RMS error, 1/255'\n"
      "set key below maxrows 2 font ',8'\nset multiplot layout {},{}\n",
      380 * contents.scenes.size(), 320 * contents.appearances.size(), quoted(png.string()),
      contents.appearances.size(), contents.scenes.size());
  for (const std::string& appearance : contents.appearances) {
    for (const std::string& scene : contents.scenes) {
      std::string curves;
      for (std::size_t n = 0; n < contents.renderers.size(); ++n) {
        const std::string points = points_of(contents, scene, appearance, contents.renderers[n]);
        if (points.empty()) continue;
        script += fmt::format("$curve{} << EOD\n{}EOD\n", n, points);
        curves += fmt::format("{}$curve{} with linespoints lw 2 pt 7 lc {} title {}",
                              curves.empty() ? "" : ", ", n, n + 1, quoted(contents.renderers[n]));
      }
      script += fmt::format(
          "set title {}\nplot {}\n",
          quoted(fmt::format("{}, {}, {}x{}", scene, appearance, contents.size, contents.size)), curves);
    }
  }
  return script + "unset multiplot\nset output\n";
}

Result<void> write_error_plot(std::span<const Table> tables, const std::filesystem::path& png) {
  std::filesystem::path partial = png;
  partial += fmt::format(".{}.part", getpid());
  const std::string script = error_plot_script(tables, partial);
  const auto before = std::signal(SIGPIPE, SIG_IGN);  // a missing gnuplot is an error, not a signal
  FILE* gnuplot = popen("gnuplot >/dev/null 2>&1", "w");
  bool written = gnuplot != nullptr && std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  if (gnuplot != nullptr) written = pclose(gnuplot) == 0 && written;
  std::signal(SIGPIPE, before);
  std::error_code error;
  if (written) std::filesystem::rename(partial, png, error);
  if (written && !error) return {};
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);
  return fail(ErrorCode::kFailed,
              fmt::format("{}: gnuplot (Debian's package gnuplot-nox) cannot draw it", png.string()));
}

}  // namespace splatlas
