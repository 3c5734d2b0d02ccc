// Formatter of selection text, and the options of its terms.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "format/content/selection.h"
#include "format/selection/selection_terms.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

std::string text_of(const SelectionTerm& term) {
  const bool plain =
      std::all_of(term.name.begin(), term.name.end(), is_name_character) && !is_rest(term.name);
  std::string text = plain ? term.name : '"' + term.name + '"';  // ids and "*" contain no quotes
  const bool is_default_mode = !term.ghost && term.mode == (term.remove ? DrawMode::kOff : DrawMode::kVolume);
  if (!is_default_mode) text += fmt::format(":{}", name_of(term.mode));
  const std::string options = write_options(term);
  return options.empty() ? text : fmt::format("{}({})", text, options);
}

bool have_same_appearance(const StructureDraw& a, const StructureDraw& b) {
  if (a.mode == DrawMode::kOff && b.mode == DrawMode::kOff) return true;
  return a.mode == b.mode && a.opacity == b.opacity && a.color == b.color && a.volume == b.volume &&
         a.ghost == b.ghost;
}

/// The ramp on which a term's ramp options act. A ramp option replaces a curve by the default ramp.
VolumeStyle ramp_of(const VolumeStyle& style) {
  return style.curve ? VolumeStyle{} : style;
}

/// Sets the options of `term` that turn one style into another, unless cannot_restyle().
void restyle(const VolumeStyle& current, const VolumeStyle& target, SelectionTerm& term) {
  if (current == target) return;
  if (target.curve) {
    term.curve = target.curve;
    return;
  }
  const VolumeStyle ramp = ramp_of(current);
  if (target.low != ramp.low) term.low = target.low;
  if (target.high != ramp.high) term.high = target.high;
  if (target.profile != ramp.profile || target == ramp) term.profile = target.profile;
}

/// True if no term can make the change: terms cannot reset an end of a ramp.
bool cannot_restyle(const VolumeStyle& current, const VolumeStyle& target) {
  const VolumeStyle ramp = ramp_of(current);
  return !target.curve && ((ramp.low && !target.low) || (ramp.high && !target.high));
}

/// Finds terms that turn an empty selection into the target one. Visits structures in topological order. A
/// term affects only descendants, so that it never changes a finished structure.
class TermFinder {
 public:
  TermFinder(const Selection& target, const StructureGraph& graph) : target_(target), graph_(graph) {
    current_.structures.resize(graph.size());
  }

  /// Starts with a term that selects all structures with the appearance of `draw`.
  void begin_with_all(const StructureDraw& draw) {
    SelectionTerm term{.name = "*", .mode = draw.mode, .ghost = draw.ghost, .opacity = draw.opacity};
    if (draw.ghost && draw.color != kGhostColor) term.color = draw.color;
    restyle({}, draw.volume, term);
    add_term(std::move(term), graph_.topological());
  }

  std::vector<SelectionTerm> find() {
    for (const StructureIndex s : graph_.topological()) update(s);
    return std::move(terms_);
  }

 private:
  void update(StructureIndex s) {
    const StructureDraw& target = target_.structures[s];
    const StructureDraw& current = current_.structures[s];
    if (have_same_appearance(target, current)) return;
    if (target.mode == DrawMode::kOff || must_remove_first(s)) remove(s, DrawMode::kOff);
    if (current.mode == DrawMode::kBoth && target.mode == DrawMode::kVolume) remove(s, DrawMode::kSurface);
    if (current.mode == DrawMode::kBoth && target.mode == DrawMode::kSurface) remove(s, DrawMode::kVolume);
    if (!have_same_appearance(target, current)) add(s);
  }

  /// True if a removal must precede the new term: terms cannot reset an opacity, an end of a ramp or the
  /// colors of a subtree, nor replace volume by surface.
  [[nodiscard]] bool must_remove_first(StructureIndex s) const {
    const StructureDraw& target = target_.structures[s];
    const StructureDraw& current = current_.structures[s];
    if (current.mode == DrawMode::kOff) return false;
    const bool resets = target.ghost != current.ghost;
    const bool swaps_parts =
        current.mode != target.mode && current.mode != DrawMode::kBoth && target.mode != DrawMode::kBoth;
    const bool own_color_again = target.color != current.color && target.color == graph_[s].color;
    return swaps_parts || (current.opacity && !target.opacity && !resets) ||
           cannot_restyle(current.volume, target.volume) ||
           (own_color_again && !resets && !graph_.children(s).empty());
  }

  void remove(StructureIndex s, DrawMode mode) {
    add_term({.remove = true, .name = graph_[s].id, .mode = mode}, graph_.descendants(s));
  }

  void add(StructureIndex s) {
    const StructureDraw& target = target_.structures[s];
    const StructureDraw& current = current_.structures[s];
    const bool resets = current.mode == DrawMode::kOff || target.ghost != current.ghost;
    const Rgb color = target.ghost ? kGhostColor : resets ? graph_[s].color : current.color;
    SelectionTerm term{.name = graph_[s].id, .mode = target.mode, .ghost = target.ghost};
    if (resets || target.opacity != current.opacity) term.opacity = target.opacity;
    if (target.color != color) term.color = target.color;
    restyle(current.volume, target.volume, term);
    add_term(std::move(term), graph_.descendants(s));
  }

  void add_term(SelectionTerm term, std::span<const StructureIndex> structures) {
    apply_term(term, static_cast<std::uint32_t>(terms_.size()), structures, graph_, current_);
    terms_.push_back(std::move(term));
  }

  const Selection& target_;
  const StructureGraph& graph_;
  Selection current_;
  std::vector<SelectionTerm> terms_;
};

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
  const auto part = [&text] {
    const std::size_t end = std::min(text.find(':'), text.size());
    const std::string_view first = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return first;
  };
  const bool has_shade = std::count(text.begin(), text.end(), ':') == 2;
  if (!has_shade && std::count(text.begin(), text.end(), ':') != 1) return std::nullopt;
  const auto grey = number_of<double>(part());
  const auto opacity = number_of<float>(part());
  const auto shade = has_shade ? number_of<float>(part()) : 1.0f;
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

std::string write_curve(const SelectionTerm& term) {
  std::string text;
  for (const TransferPoint& point : term.curve->points) {
    if (!text.empty()) text += '/';
    text += fmt::format("{}:{}", point.grey, point.opacity);
    if (point.shade != 1) text += fmt::format(":{}", point.shade);
  }
  return text;
}

using OptionTerm = SelectionTerm;

constexpr std::array<SelectionOption, 7> kOptions{{
    {"ghost", [](const OptionTerm& t) { return t.ghost; }, read_ghost, nullptr},
    {"opacity", [](const OptionTerm& t) { return t.opacity.has_value(); }, read_opacity,
     [](const OptionTerm& t) { return fmt::format("{}", *t.opacity); }},
    {"color", [](const OptionTerm& t) { return t.color.has_value(); }, read_color,
     [](const OptionTerm& t) { return to_hex(*t.color); }},
    {"profile", [](const OptionTerm& t) { return t.profile.has_value(); }, read_profile,
     [](const OptionTerm& t) { return std::string(name_of(*t.profile)); }},
    {"low", [](const OptionTerm& t) { return t.low.has_value(); },
     [](std::string_view value, OptionTerm& t) { return read_end(value, "low", t.low, t); },
     [](const OptionTerm& t) { return fmt::format("{}", *t.low); }},
    {"high", [](const OptionTerm& t) { return t.high.has_value(); },
     [](std::string_view value, OptionTerm& t) { return read_end(value, "high", t.high, t); },
     [](const OptionTerm& t) { return fmt::format("{}", *t.high); }},
    {"curve", [](const OptionTerm& t) { return t.curve != nullptr; }, read_curve, write_curve},
}};

}  // namespace

std::string to_text(const Selection& selection, const StructureGraph& graph) {
  std::vector<SelectionTerm> terms = TermFinder(selection, graph).find();

  // "All but a few" is shorter if most structures are selected. It makes one hull of all ghosts.
  const auto cost = [](const std::vector<SelectionTerm>& of) {
    return std::pair(std::ranges::count(of, true, &SelectionTerm::ghost), of.size());
  };
  const auto try_all_but = [&](const StructureDraw& draw) {
    TermFinder finder(selection, graph);
    finder.begin_with_all(draw);
    std::vector<SelectionTerm> all_but = finder.find();
    if (cost(all_but) < cost(terms)) terms = std::move(all_but);
  };
  const auto is_on = [&](StructureIndex s) { return selection.structures[s].mode != DrawMode::kOff; };
  const auto root = std::find_if(graph.roots().begin(), graph.roots().end(), is_on);
  if (root != graph.roots().end()) try_all_but(selection.structures[*root]);
  const auto is_ghost = [](const StructureDraw& draw) { return draw.mode != DrawMode::kOff && draw.ghost; };
  const auto ghost = std::ranges::find_if(selection.structures, is_ghost);
  if (ghost != selection.structures.end()) try_all_but(*ghost);

  std::string text;
  for (const SelectionTerm& term : terms) {
    if (!text.empty()) text += term.remove ? " - " : " + ";
    text += text_of(term);
  }
  return text;
}

const SelectionOption* find_option(std::string_view name) {
  const auto* const found = std::ranges::find_if(
      kOptions, [&](const SelectionOption& option) { return equal_ignoring_case(name, option.name); });
  return found == kOptions.end() ? nullptr : found;
}

std::string write_options(const SelectionTerm& term) {
  std::string text;
  for (const SelectionOption& option : kOptions) {
    if (!option.is_given(term)) continue;
    if (!text.empty()) text += ',';
    text += option.name;
    if (option.write != nullptr) text += '=' + option.write(term);
  }
  return text;
}

}  // namespace splatlas
