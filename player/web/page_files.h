// The files of the page that `export --html` writes, embedded in the program when it is built.
#pragma once

#include <string_view>

namespace splatlas {

/// The page's markup, with places for its contents: "{{name}}".
[[nodiscard]] std::string_view page_template();
/// Style sheet.
[[nodiscard]] std::string_view page_style();
/// Markup and style sheet of a catalogue.
[[nodiscard]] std::string_view catalogue_template();
[[nodiscard]] std::string_view catalogue_style();
/// The page's script: its sources in the order of their use.
[[nodiscard]] std::string_view page_script();
/// The script of its workers.
[[nodiscard]] std::string_view worker_script();
/// splatlas.wasm, compressed by gzip. Empty if the program was built without it.
[[nodiscard]] std::string_view web_module_gzip();

}  // namespace splatlas
