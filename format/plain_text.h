// Text that can be shown on any terminal and in any window.
#pragma once

#include <string>
#include <string_view>

namespace splatlas {

/// What is wrong with a text that an atlas may not have, as the end of a sentence; "" for UTF-8 without
/// control characters but line feed and tab, and without characters that turn text around.
[[nodiscard]] std::string fault_of_text(std::string_view text);

}  // namespace splatlas
