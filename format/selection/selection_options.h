// The options of a term, each with how it is read and written.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "format/selection.h"

namespace splatlas {

struct OptionFault {
  std::size_t offset = 0;  ///< in the value
  std::string what;
};
using OptionResult = tl::expected<void, OptionFault>;

struct SelectionOption {
  std::string_view name;
  bool (*is_given)(const SelectionTerm& term);
  /// The term keeps what it had when the value is refused.
  OptionResult (*read)(std::string_view value, SelectionTerm& term);
  /// The value, for a term that has one: read() gives it back exactly.
  std::string (*write)(const SelectionTerm& term);
};

/// In the order in which they are written.
[[nodiscard]] std::span<const SelectionOption> selection_options();
/// Without regard to the case of ASCII letters; null when there is none of this name.
[[nodiscard]] const SelectionOption* find_option(std::string_view name);

}  // namespace splatlas
