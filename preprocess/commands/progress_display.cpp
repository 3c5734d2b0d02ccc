#include "preprocess/commands/progress_display.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/ioctl.h>
#include <unistd.h>

#include "format/program/standard_output.h"
#include "format/text/json_text.h"

namespace splatlas {
namespace {

/// Linear estimate of the remaining seconds from the completed work.
std::optional<double> estimate_remaining(const BuildProgress& progress) {
  constexpr double kMinFraction = 0.05;
  if (progress.total_fraction < kMinFraction) return std::nullopt;
  return progress.total_seconds * (1 - progress.total_fraction) / progress.total_fraction;
}

std::string bar(double fraction, int width) {
  const int filled = static_cast<int>(std::lround(fraction * width));
  return std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(width - filled), '.');
}

/// Width of the terminal behind `stream`.
int columns_of(std::FILE* stream) {
  constexpr int kDefault = 80;
  winsize size{};
  const bool known = ::ioctl(::fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : kDefault;
}

}  // namespace

ProgressMode automatic_progress(std::FILE* stream) {
  return ::isatty(::fileno(stream)) != 0 ? ProgressMode::kBar : ProgressMode::kLines;
}

std::string remaining_time(const BuildProgress& progress) {
  const auto seconds = estimate_remaining(progress);
  if (!seconds) return "";
  if (*seconds < 100) return fmt::format("about {:.0f} s left", std::ceil(*seconds));
  return fmt::format("about {:.0f} min left", std::ceil(*seconds / 60));
}

void ProgressDisplay::show(const BuildProgress& progress) {
  // The end of the stage is reported separately, with its time.
  if (progress.stage_fraction >= 1 && !progress.stage_ended) return;
  const auto now = std::chrono::steady_clock::now();
  const bool ends_or_begins = progress.stage_ended || progress.stage != stage_;
  stage_ = progress.stage;
  constexpr std::chrono::milliseconds kPause{100};
  if (!ends_or_begins && now - last_shown_ < kPause) return;
  last_shown_ = now;
  switch (mode_) {
    case ProgressMode::kBar: return show_bar(progress);
    case ProgressMode::kJson: return show_json(progress);
    case ProgressMode::kLines:
      if (progress.stage_ended)
        print_to(stream_, PrintableText("{:<10} {:6.2f} s\n", progress.stage, progress.stage_seconds));
      return;
    case ProgressMode::kNone: return;
  }
}

void ProgressDisplay::show_bar(const BuildProgress& progress) {
  const bool ended = progress.stage_ended;
  const std::string time =
      ended ? fmt::format("{:6.2f} s", progress.stage_seconds) : remaining_time(progress);
  // Never let a line wrap: "\r" returns to the start of the last row only.
  constexpr int kRest = 40, kWidestBar = 24;
  const int columns = columns_of(stream_);
  const int width = std::clamp(columns - kRest, 0, kWidestBar);
  const std::string line =
      fmt::format("{:<10} [{}] {:3.0f} %  {}", progress.stage, bar(progress.stage_fraction, width),
                  100 * progress.stage_fraction, time);
  PrintableText text("\r{}\x1b[K", line.substr(0, static_cast<std::size_t>(columns - 1)));
  print_to(stream_, ended ? text.add("\n") : text);
  line_open_ = !ended;
}

void ProgressDisplay::show_json(const BuildProgress& progress) {
  const auto milli = [](double value) { return std::round(1000 * value) / 1000; };
  nlohmann::ordered_json line{{"stage", progress.stage},
                              {"stage_fraction", milli(progress.stage_fraction)},
                              {"fraction", milli(progress.total_fraction)},
                              {"stage_seconds", milli(progress.stage_seconds)},
                              {"seconds", milli(progress.total_seconds)}};
  if (const auto remaining = estimate_remaining(progress)) line["remaining_seconds"] = milli(*remaining);
  print_to(stream_, PrintableText::of_layout(json_text(line, -1)));
}

void ProgressDisplay::finish() {
  if (line_open_) print_to(stream_, PrintableText("\n"));
  line_open_ = false;
}

}  // namespace splatlas
