// Options of the terms of selection text.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/selection/selection_terms.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

tl::unexpected<OptionFault> fault(std::string what, std::size_t offset = 0) {
  return tl::unexpected<OptionFault>({offset, std::move(what)});
}

/// Parses text that is exactly one finite number.
template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  const auto number = parse_number<Number>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

OptionResult read_opacity(std::string_view value, SelectionTerm& term) {
  const auto opacity = number_of<float>(value);
  if (!opacity || !(*opacity > 0 && *opacity <= 1)) {
    return fault(fmt::format("opacity {} must be above 0 and at most 1", in_quotes(value)));
  }
  term.opacity = opacity;
  return {};
}

OptionResult read_ghost(std::string_view, SelectionTerm& term) {
  term.ghost = true;
  return {};
}

OptionResult read_color(std::string_view value, SelectionTerm& term) {
  const auto color = parse_color(value);
  if (!color) return fault(fmt::format("{} is not a color: write #rrggbb", in_quotes(value)));
  term.color = *color;
  return {};
}

/// Refuses an option of ramps in a term with a curve.
OptionResult check_no_curve(const SelectionTerm& term, std::string_view name) {
  if (!term.curve) return {};
  return fault(fmt::format("{} does not go with curve: leave out one of them", name));
}

OptionResult read_profile(std::string_view value, SelectionTerm& term) {
  if (auto checked = check_no_curve(term, "profile"); !checked) return checked;
  for (const TransferProfile profile :
       {TransferProfile::kSoft, TransferProfile::kThin, TransferProfile::kHard}) {
    if (!equal_ignoring_case(value, name_of(profile))) continue;
    term.profile = profile;
    return {};
  }
  return fault(fmt::format("{} is not a profile: write soft, thin or hard", in_quotes(value)));
}

OptionResult read_end(std::string_view value, std::string_view name, std::optional<double>& end,
                      SelectionTerm& term) {
  if (auto checked = check_no_curve(term, name); !checked) return checked;
  const auto grey = number_of<double>(value);
  if (!grey) return fault(fmt::format("{} {} is not a grey value: write a number", name, in_quotes(value)));
  end = grey;
  if (!term.low || !term.high || *term.low < *term.high) return {};
  std::string what = fmt::format("low {} must be below high {}", *term.low, *term.high);
  end.reset();
  return fault(std::move(what));
}

/// Parses "grey:opacity" or "grey:opacity:shade".
std::optional<TransferPoint> point_of(std::string_view text) {
  const std::vector<std::string_view> parts = split(text, ':');
  if (parts.size() != 2 && parts.size() != 3) return std::nullopt;
  const auto grey = number_of<double>(parts[0]);
  const auto opacity = number_of<float>(parts[1]);
  const auto shade = parts.size() == 3 ? number_of<float>(parts[2]) : 1.0f;
  if (!grey || !opacity || !shade) return std::nullopt;
  return TransferPoint{*grey, *opacity == 1 ? kMaxVolumeOpacity : *opacity, *shade};
}

OptionResult read_curve(std::string_view value, SelectionTerm& term) {
  if (term.profile || term.low || term.high) {
    return fault("curve does not go with profile, low or high: leave out one of them");
  }
  TransferCurve curve;
  for (std::size_t start = 0; start <= value.size();) {
    const std::size_t end = std::min(value.find('/', start), value.size());
    const std::string_view text = value.substr(start, end - start);
    const auto point = point_of(text);
    if (!point) {
      return fault(
          fmt::format(
              "{} is not a point of a curve: write grey:opacity or grey:opacity:shade, as in 40:0/160:0.3",
              in_quotes(text)),
          start);
    }
    curve.points.push_back(*point);
    // Check after every point, to report the first fault and its offset.
    if (const auto checked = check_curve(curve); !checked) return fault(checked.error().message, start);
    start = end + 1;
  }
  term.curve = std::make_shared<const TransferCurve>(std::move(curve));
  return {};
}

using OptionTerm = SelectionTerm;

constexpr std::array<SelectionOption, 7> kOptions{{
    {"ghost", [](const OptionTerm& t) { return t.ghost; }, read_ghost, true},
    {"opacity", [](const OptionTerm& t) { return t.opacity.has_value(); }, read_opacity},
    {"color", [](const OptionTerm& t) { return t.color.has_value(); }, read_color},
    {"profile", [](const OptionTerm& t) { return t.profile.has_value(); }, read_profile},
    {"low", [](const OptionTerm& t) { return t.low.has_value(); },
     [](std::string_view value, OptionTerm& t) { return read_end(value, "low", t.low, t); }},
    {"high", [](const OptionTerm& t) { return t.high.has_value(); },
     [](std::string_view value, OptionTerm& t) { return read_end(value, "high", t.high, t); }},
    {"curve", [](const OptionTerm& t) { return t.curve != nullptr; }, read_curve},
}};

}  // namespace

const SelectionOption* find_option(std::string_view name) {
  const auto* const found = std::ranges::find_if(
      kOptions, [&](const SelectionOption& option) { return equal_ignoring_case(name, option.name); });
  return found == kOptions.end() ? nullptr : found;
}

}  // namespace splatlas
