// Semantics of a selection term, shared by the parser and the formatter.
#pragma once

#include <cstdint>
#include <span>

#include "format/selection.h"

namespace splatlas {

/// Applies term `number` (from 0) to `structures`. The caller includes descendants.
void apply_term(const SelectionTerm& term, std::uint32_t number, std::span<const StructureIndex> structures,
                const StructureGraph& graph, Selection& selection);

/// True if unquoted names may contain the character.
[[nodiscard]] bool is_name_character(char c);

}  // namespace splatlas
