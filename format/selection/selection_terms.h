// Semantics and options of the terms of a selection.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "format/content/selection.h"

namespace splatlas {

/// The structures of a term's name or label, without descendants. Empty for the rest, and for the name "*" in
/// a graph without structures. kNotFound if there are none.
[[nodiscard]] Result<std::vector<StructureIndex>> find_target(const StructureGraph& graph,
                                                              const SelectionTerm& term);

/// A syntax or range error in the value of an option.
struct OptionFault {
  std::size_t offset = 0;  ///< byte offset in the value
  std::string what;
};
using OptionResult = tl::expected<void, OptionFault>;

/// An option of a term, in the table of selection_text.cpp.
struct SelectionOption {
  std::string_view name;
  bool (*is_given)(const SelectionTerm& term);
  /// Parses a value. Leaves the term unchanged on error.
  OptionResult (*read)(std::string_view value, SelectionTerm& term);
  bool is_flag = false;  ///< without a value
};

/// Finds an option by name, ignoring the case of ASCII letters; null if there is none.
[[nodiscard]] const SelectionOption* find_option(std::string_view name);

}  // namespace splatlas
