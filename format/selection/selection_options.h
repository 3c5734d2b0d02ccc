// Table of the options of a selection term, with parsers and formatters.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "format/content/selection.h"

namespace splatlas {

/// A syntax or range error in the value of an option.
struct OptionFault {
  std::size_t offset = 0;  ///< byte offset in the value
  std::string what;
};
using OptionResult = tl::expected<void, OptionFault>;

/// One option.
struct SelectionOption {
  std::string_view name;
  bool (*is_given)(const SelectionTerm& term);
  /// Parses a value. Leaves the term unchanged on error.
  OptionResult (*read)(std::string_view value, SelectionTerm& term);
  /// Formats the value of a term with this option. read() restores it exactly. Null for a flag.
  std::string (*write)(const SelectionTerm& term);
};

/// Finds an option by name, ignoring the case of ASCII letters; null if there is none.
[[nodiscard]] const SelectionOption* find_option(std::string_view name);
/// The options that a term has, separated by commas: "opacity=0.4,color=#ff8800".
[[nodiscard]] std::string write_options(const SelectionTerm& term);

}  // namespace splatlas
