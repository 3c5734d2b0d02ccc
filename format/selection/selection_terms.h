// What one term of a selection does; shared by those who read and who write selection text.
#pragma once

#include <cstdint>
#include <span>

#include "format/selection.h"

namespace splatlas {

/// Applies a term to `structures`, descendants included by the caller. `number` is the term's, from 0.
void apply_term(const SelectionTerm& term, std::uint32_t number, std::span<const StructureIndex> structures,
                const StructureGraph& graph, Selection& selection);

/// Can this character stand in a name that is not quoted?
[[nodiscard]] bool is_name_character(char c);

}  // namespace splatlas
