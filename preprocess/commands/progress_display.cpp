#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "format/program/standard_output.h"
#include "format/text/json_text.h"
#include "preprocess/commands/commands.h"

namespace splatlas {
namespace {

/// Linear estimate of the remaining seconds from the completed work.
std::optional<double> estimate_remaining(const BuildProgress& progress) {
  constexpr double kMinFraction = 0.05;
  if (progress.total_fraction < kMinFraction) return std::nullopt;
  return progress.total_seconds * (1 - progress.total_fraction) / progress.total_fraction;
}

/// "about 12 s left"; empty before an estimate is possible.
std::string remaining_time(const BuildProgress& progress) {
  const auto seconds = estimate_remaining(progress);
  if (!seconds) return "";
  if (*seconds < 100) return fmt::format("about {:.0f} s left", std::ceil(*seconds));
  return fmt::format("about {:.0f} min left", std::ceil(*seconds / 60));
}

}  // namespace

ProgressMode automatic_progress(std::FILE* stream) {
  return ::isatty(::fileno(stream)) != 0 ? ProgressMode::kPercent : ProgressMode::kLines;
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
    case ProgressMode::kPercent: return show_percent(progress);
    case ProgressMode::kJson: return show_json(progress);
    case ProgressMode::kLines:
      if (progress.stage_ended)
        print_to(stream_, PrintableText("{:<10} {:6.2f} s\n", progress.stage, progress.stage_seconds));
      return;
    case ProgressMode::kNone: return;
  }
}

void ProgressDisplay::show_percent(const BuildProgress& progress) {
  const bool ended = progress.stage_ended;
  const std::string time =
      ended ? fmt::format("{:6.2f} s", progress.stage_seconds) : remaining_time(progress);
  PrintableText text("\r{:<10} {:3.0f} %  {}\x1b[K", progress.stage, 100 * progress.stage_fraction, time);
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
