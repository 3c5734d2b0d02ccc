// The selection language: one text for the command line, scenes and the window.
//
//   selection := term { ("+" | "-") term }
//   term      := NAME [":surface" | ":volume" | ":both"] [ "(" option { "," option } ")" ]
//   option    := "opacity=" number in (0, 1]  |  "color=" "#rrggbb"
//              | "profile=" ("soft" | "thin" | "hard")  |  "low=" grey value  |  "high=" grey value
//              | "curve=" point { "/" point }
//   point     := grey value ":" opacity from 0 to 0.9999 [":" shade from 0 to 1]
//   NAME      := a structure's id, name or path ("Brain/Cerebellum/Left"); "*" stands for any characters, "/"
//   too;
//                in double quotes where it holds anything but letters, digits, "_", ".", "/", "*", "'" and
//                characters beyond ASCII; a double quote inside quotes is written twice
//
// Names, modes and options are compared without regard to the case of ASCII letters. Blanks between the parts
// do not count. Terms apply from left to right, each to the structures its NAME stands for and all their
// descendants:
//   - a term that adds gives them its mode (volume where none is written) beside those that they have:
//     "A:volume + A:surface" is "A:both"; "A:both - A:surface" takes the surface away again;
//   - its options replace those of earlier terms; where it has none, theirs stay. A curve replaces profile,
//     low and high, and each of them replaces a curve; a low that is not below the high of an earlier term
//     forgets that high, and the other way round;
//   - "- NAME" and "- NAME:both" remove a structure and forget its looks, "- NAME:surface" and "-
//   NAME:volume"
//     only that part. Removals take no options.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/color.h"
#include "format/result.h"
#include "format/structure_graph.h"
#include "format/transfer_curve.h"

namespace splatlas {

enum class DrawMode : std::uint8_t { kOff, kVolume, kSurface, kBoth };

/// "off", "volume", "surface", "both".
[[nodiscard]] const char* name_of(DrawMode mode);

/// The shape of a volume's ramp from clear at its low end to its opacity at the high end. Shades rise alike.
enum class TransferProfile : std::uint8_t {
  kSoft,  ///< from end to end
  kThin,  ///< the same, all but clear by default
  kHard,  ///< a step in the middle, one hundredth of the ramp wide
};

/// "soft", "thin", "hard".
[[nodiscard]] const char* name_of(TransferProfile profile);

/// The transfer function of one structure's volume as a selection words it: a ramp, or a curve. The player
/// makes a TransferCurve of it (player/transfer_function.h). Surfaces have none.
struct VolumeStyle {
  TransferProfile profile = TransferProfile::kSoft;
  /// Grey values of the ramp's ends, finite; low < high where both are set. Not set: the display window's.
  std::optional<double> low = std::nullopt, high = std::nullopt;
  /// Instead of a ramp; the others are as they are by default then. Passes check_curve().
  std::shared_ptr<const TransferCurve> curve = nullptr;
  /// Curves are compared by their points.
  friend bool operator==(const VolumeStyle& a, const VolumeStyle& b);
};

/// One term as written.
struct SelectionTerm {
  bool remove = false;
  std::string name;
  DrawMode mode = DrawMode::kOff;  ///< kOff: none was written
  std::optional<float> opacity = std::nullopt;
  std::optional<Rgb> color = std::nullopt;
  std::optional<TransferProfile> profile = std::nullopt;
  std::optional<double> low = std::nullopt, high = std::nullopt;
  std::shared_ptr<const TransferCurve> curve = nullptr;  ///< then neither profile nor low nor high
  std::size_t column = 0;  ///< where the term starts in the text, from 0; for messages
};

/// How one structure is drawn; StructureDraw{} when it is not.
struct StructureDraw {
  DrawMode mode = DrawMode::kOff;
  /// Surfaces: of each crossing. Volumes: of one reference length (Atlas::reference_length_mm) at full value,
  /// which is where the transfer function is densest. Not set: the renderer's default for the mode and
  /// profile, a curve's own.
  std::optional<float> opacity = std::nullopt;
  Rgb color = {};
  std::uint32_t term =
      0;  ///< number of the latest term that selected it: later terms win where looks compete
  VolumeStyle volume = {};
  friend bool operator==(const StructureDraw&, const StructureDraw&) = default;
};

/// What to draw of every structure (index = StructureIndex). Only structures themselves, no inheritance: the
/// descendants of a selected node are selected one by one.
struct Selection {
  std::vector<StructureDraw> structures;
  friend bool operator==(const Selection&, const Selection&) = default;
  [[nodiscard]] bool empty() const;
};

/// Syntax only; kUsage with the column (bytes, from 1) of the first fault. An empty or blank text has no
/// terms.
[[nodiscard]] Result<std::vector<SelectionTerm>> parse_selection(std::string_view text);

/// The structures that a name, id, path or wildcard pattern stands for (without descendants), in index order.
/// An id wins over names, a name over paths. A path may start at a root or further down ("Cerebellum/Left").
/// A wildcard matches ids, names and whole paths. kNotFound when nothing matches, or when a name or path
/// without a wildcard matches several structures; the message lists the nearest names, or the candidates'
/// paths and ids. Cost: linear in the structures, their parents and names, times the length of a wildcard
/// pattern (at most 256).
[[nodiscard]] Result<std::vector<StructureIndex>> find_structures(const StructureGraph& graph,
                                                                  std::string_view name);

/// Applies the terms to the graph. kNotFound, with the term's column, when a name is unknown or ambiguous.
[[nodiscard]] Result<Selection> resolve_selection(std::span<const SelectionTerm> terms,
                                                  const StructureGraph& graph);
/// parse_selection and resolve_selection in one.
[[nodiscard]] Result<Selection> select(std::string_view text, const StructureGraph& graph);

/// A short text that selects exactly this: a whole subtree that is drawn alike becomes one term, what is
/// missing from it a removal. select(to_text(s, g), g) gives `s` again but for term numbers. `selection` is
/// one of this graph, its opacities in (0, 1], its
/// styles as VolumeStyle has them.
[[nodiscard]] std::string to_text(const Selection& selection, const StructureGraph& graph);

}  // namespace splatlas
