// Selection language of the command line, scenes and the window: docs/selections.md has its grammar.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/color.h"
#include "format/content/structure_graph.h"
#include "format/content/transfer_curve.h"
#include "format/result.h"

namespace splatlas {

enum class DrawMode : std::uint8_t { kOff, kVolume, kSurface, kBoth };

/// "off", "volume", "surface", "both".
[[nodiscard]] const char* name_of(DrawMode mode);

/// Shape of a transfer function's ramp, and its shade, from transparent at `low` to full opacity at `high`.
enum class TransferProfile : std::uint8_t {
  kSoft,  ///< linear over the whole interval
  kThin,  ///< like kSoft, with a very low default opacity
  kHard,  ///< a step in the middle, one hundredth of the interval wide
};

/// "soft", "thin", "hard".
[[nodiscard]] const char* name_of(TransferProfile profile);

/// Specification of the transfer function of one structure's volume: a ramp or a curve. The player converts
/// it to a TransferCurve (player/transfer_function.h).
struct VolumeStyle {
  TransferProfile profile = TransferProfile::kSoft;
  /// Grey values of the ramp's ends, finite, low < high. Defaults: those of the display window.
  std::optional<double> low = std::nullopt, high = std::nullopt;
  /// Replaces the ramp; then all other members have their defaults. Must pass check_curve().
  std::shared_ptr<const TransferCurve> curve = nullptr;
  /// Compares curves by their points.
  friend bool operator==(const VolumeStyle& a, const VolumeStyle& b);
};

/// Kind of a term's target.
enum class TermTarget : std::uint8_t { kName, kLabel, kRest };

/// One parsed term.
struct SelectionTerm {
  bool remove = false;
  TermTarget target = TermTarget::kName;
  std::string name;                ///< without quotes; "#17" of a label, "rest"
  std::int64_t label = 0;          ///< of kLabel
  DrawMode mode = DrawMode::kOff;  ///< kOff if not given
  bool ghost = false;
  std::optional<float> opacity = std::nullopt;
  std::optional<Rgb> color = std::nullopt;
  std::optional<TransferProfile> profile = std::nullopt;
  std::optional<double> low = std::nullopt, high = std::nullopt;
  std::shared_ptr<const TransferCurve> curve = nullptr;  ///< excludes profile, low and high
  std::size_t column = 0;  ///< byte offset of the term in the text, for messages
};

/// Opacity of a ghost at its rim, and colour, by default.
inline constexpr float kGhostOpacity = 0.7f;
inline constexpr Rgb kGhostColor{144, 144, 144};

/// Draw mode and appearance of one structure; StructureDraw{} if it is not selected.
struct StructureDraw {
  DrawMode mode = DrawMode::kOff;
  /// Opacity from 0 to 1 per crossing of a surface. For volumes, opacity per reference length
  /// (Atlas::reference_length_mm) at the maximum of the transfer function. Default: that of the mode and
  /// profile, or that of the curve.
  std::optional<float> opacity = std::nullopt;
  Rgb color = {};
  /// Latest term that selected it: where structures overlap, the higher number takes precedence. Terms are
  /// numbered from 0: first those for the rest, then the others, in the order of the text.
  std::uint32_t term = 0;
  VolumeStyle volume = {};
  /// Draws the surfaces of the same term as one hull: the first crossing of a ray alone, more opaque at the
  /// rim. The opacity is that of the rim; default: kGhostOpacity.
  bool ghost = false;
  friend bool operator==(const StructureDraw&, const StructureDraw&) = default;
};

/// Draw mode and appearance of every structure, by StructureIndex. Nothing is inherited: the descendants of a
/// selected structure have entries of their own.
struct Selection {
  std::vector<StructureDraw> structures;

  /// Parses selection text: parse_selection() followed by resolve_selection().
  [[nodiscard]] static Result<Selection> parse(std::string_view text, const StructureGraph& graph);
  [[nodiscard]] bool empty() const;
  friend bool operator==(const Selection&, const Selection&) = default;
};

/// kUsage with the first invalid structure, its index and the value:
///   - more structures than the graph; missing ones are off
///   - a mode or profile that is no enumerator
///   - an opacity outside [0, 1]
///   - ends of a ramp that are not finite, or low not below high
///   - a curve that fails check_curve(), or with a profile, low or high beside it
/// Structures that are off may have any appearance. O(structures and points of curves), thread-safe.
[[nodiscard]] Result<void> check_selection(const Selection& selection, const StructureGraph& graph);

/// Parses selection text without resolving names. A blank text has no terms. kUsage with the column (bytes,
/// from 1) of the first fault. Throws as check_task().
[[nodiscard]] Result<std::vector<SelectionTerm>> parse_selection(std::string_view text);

/// Applies the terms to the graph. kNotFound, with the column of the term, if a name or label is unknown or
/// ambiguous. `colors`: [structure], in place of the graph's colours unless empty.
/// The name "*" selects nothing in a graph without structures. Throws as check_task(). Cost: linear in the
/// terms, the structures of each, and the graph; a pass over the graph for each path, pattern or term.
[[nodiscard]] Result<Selection> resolve_selection(std::span<const SelectionTerm> terms,
                                                  const StructureGraph& graph,
                                                  std::span<const Rgb> colors = {});

/// An added term that later terms make superfluous: they select its structures in the same way.
struct HiddenTerm {
  std::size_t term = 0, hidden_by = 0;  ///< numbers of the terms in the text, from 0
  std::string message;                  ///< one line: column, both names, remedy
  friend bool operator==(const HiddenTerm&, const HiddenTerm&) = default;
};

/// Finds these terms, in the order of the text, among at most 64. Removals hide nothing: they are what was
/// asked for. kNotFound as for resolve_selection(), whose cost it has for each term. Thread-safe.
[[nodiscard]] Result<std::vector<HiddenTerm>> find_hidden_terms(std::span<const SelectionTerm> terms,
                                                                const StructureGraph& graph);

}  // namespace splatlas
