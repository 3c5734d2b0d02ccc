#include "player/commands/annotate_options.h"

#include <algorithm>
#include <array>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/program/command_options.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

using Item = std::pair<std::string_view, bool AnnotationItems::*>;
constexpr std::array kItems{
    Item{"labels", &AnnotationItems::labels},      Item{"legend", &AnnotationItems::legend},
    Item{"scalebar", &AnnotationItems::scale_bar}, Item{"orientation", &AnnotationItems::orientation},
    Item{"caption", &AnnotationItems::caption},    Item{"citation", &AnnotationItems::citation}};
constexpr std::string_view kAll = "all";

std::string item_names() {
  std::string names;
  for (const auto& [name, member] : kItems) names += std::string(name) + ", ";
  return names + "or " + std::string(kAll);
}

template <typename Number>
std::optional<Number> number_within(std::string_view text, Number min, Number max) {
  const auto number = parse_number<Number>(text);
  return number && *number >= min && *number <= max ? number : std::nullopt;
}

/// Parses a list of items: "labels,legend". kUsage, with the valid names.
Result<AnnotationItems> parse_annotations(std::string_view text) {
  AnnotationItems items;
  while (true) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view name = text.substr(0, comma);
    const auto found = std::ranges::find(kItems, name, &Item::first);
    if (found == kItems.end() && name != kAll) {
      return fail(ErrorCode::kUsage, "{} is no annotation; use {}, separated by commas",
                  in_quotes(std::string(name)), item_names());
    }
    for (const auto& [other, member] : kItems) items.*member |= name == kAll || name == other;
    if (comma == text.size()) return items;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace

void add_annotations(CLI::App& command, PageOptions& options) {
  const auto parse = [&options](const std::string& text) {
    const auto items = parse_annotations(text);
    if (!items) throw CLI::ValidationError("--annotate", items.error().message);
    options.items = *items;
  };
  CLI::Option* annotate = command.add_option_function<std::string>(
      "--annotate", parse, item_names() + ", separated by commas: items to draw over the picture");
  const auto needs_it = [&](CLI::Option* option) { option->needs(annotate); };
  const auto line = [](std::string_view text) {
    return printable(text) == text ? std::optional<std::string>(text) : std::nullopt;
  };
  needs_it(add_parsed(command, "--caption", options.caption, line,
                      "must be one line of visible UTF-8 characters",
                      "text below the picture; default: that of --scene, or the title of the atlas"));
  const auto labels = [](std::string_view text) { return number_within<std::size_t>(text, 0, 1000); };
  needs_it(add_parsed(command, "--max-labels", options.max_labels, labels, "must be a number from 0 to 1000",
                      "names the largest structures only")
               ->default_str(fmt::to_string(options.max_labels)));
  const auto font = [](std::string_view text) {
    return text.empty() ? std::nullopt : std::optional<std::filesystem::path>(text);
  };
  needs_it(add_parsed(command, "--font", options.font, font, "must name a file",
                      "font file of the annotations; others stand in for letters that it lacks"));
  const auto dpi = [](std::string_view text) { return number_within<double>(text, kMinDpi, kMaxDpi); };
  add_parsed(command, "--dpi", options.dpi, dpi,
             fmt::format("must be a number from {} to {}", kMinDpi, kMaxDpi),
             "pixels per inch in print; A4 at 300: --size 2480x3508, or 3508x2480");
}

}  // namespace splatlas
