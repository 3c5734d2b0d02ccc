// The selection language: one text for the command line, scenes and the window.
//
//   selection := term { ("+" | "-") term }
//   term      := NAME [":surface" | ":volume" | ":both"] [ "(" option { "," option } ")" ]
//   option    := "opacity=" number in (0, 1]  |  "color=" "#rrggbb"
//   NAME      := a structure's id, name or path ("Brain/Cerebellum/Left"); "*" stands for any characters;
//                quoted where it holds a blank, a sign, a colon, a comma or a bracket
//
// Names are compared without regard to case. Terms apply from left to right; a term that adds without a mode
// adds the volume. "-NAME" removes, "-NAME:surface" removes only the surface. A node stands for all its
// descendants.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/color.h"
#include "format/result.h"
#include "format/structure_graph.h"

namespace splatlas {

enum class DrawMode : std::uint8_t { kOff, kVolume, kSurface, kBoth };

/// "off", "volume", "surface", "both".
[[nodiscard]] const char* name_of(DrawMode mode);

/// One term as written.
struct SelectionTerm {
  bool remove = false;
  std::string name;
  DrawMode mode = DrawMode::kOff;  ///< kOff: none was written
  std::optional<float> opacity;
  std::optional<Rgb> color;
  std::size_t column = 0;  ///< where the term starts in the text, from 0; for messages
};

/// How one structure is drawn.
struct StructureDraw {
  DrawMode mode = DrawMode::kOff;
  /// Surfaces: of each crossing. Volumes: of one reference length (Atlas::reference_length_mm) at full value.
  /// Not set: the renderer's default for the mode.
  std::optional<float> opacity;
  Rgb color;
  std::uint32_t term =
      0;  ///< number of the latest term that selected it: later terms win where looks compete
  friend bool operator==(const StructureDraw&, const StructureDraw&) = default;
};

/// What to draw of every structure (index = StructureIndex). Only structures themselves, no inheritance: the
/// descendants of a selected node are selected one by one.
struct Selection {
  std::vector<StructureDraw> structures;
  friend bool operator==(const Selection&, const Selection&) = default;
  [[nodiscard]] bool empty() const;
};

/// Syntax only; kUsage with the column of the first fault. An empty or blank text has no terms.
[[nodiscard]] Result<std::vector<SelectionTerm>> parse_selection(std::string_view text);

/// The structures that a name, id, path or wildcard pattern stands for (without descendants). An id wins over
/// names, a name over paths. kNotFound when nothing matches, or when a plain name matches several structures;
/// the message lists the nearest names, or the candidates' paths.
[[nodiscard]] Result<std::vector<StructureIndex>> find_structures(const StructureGraph& graph,
                                                                  std::string_view name);

/// Applies the terms to the graph.
[[nodiscard]] Result<Selection> resolve_selection(std::span<const SelectionTerm> terms,
                                                  const StructureGraph& graph);
/// parse_selection and resolve_selection in one.
[[nodiscard]] Result<Selection> select(std::string_view text, const StructureGraph& graph);

/// A short text that selects exactly this: whole subtrees become one term where all below is drawn alike.
/// select(to_text(s, g), g) gives `s` again but for term numbers.
[[nodiscard]] std::string to_text(const Selection& selection, const StructureGraph& graph);

}  // namespace splatlas
