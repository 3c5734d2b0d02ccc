// A page that plays an atlas, as one HTML file without references to others.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "format/result.h"

namespace splatlas {

/// Contents of a page.
struct HtmlPage {
  std::span<const std::byte> atlas;    ///< bytes of the file
  std::string title;                   ///< any text; empty: a general one
  std::string caption;                 ///< any text, of the opening picture
  std::string opening;                 ///< JSON: the selection and the camera of the opening picture
  std::span<const std::byte> picture;  ///< the opening picture as WebP
};

/// The bytes of the file. Texts are escaped; the content security policy allows the page's own script, style
/// and workers alone, by their SHA-256. kFailed if this program was built without the WebAssembly module,
/// with the remedy. Memory: twice the atlas.
[[nodiscard]] Result<std::string> encode_html(const HtmlPage& page);

/// kFailed, with the remedy, if this program was built without the WebAssembly module.
[[nodiscard]] Result<void> check_web_module();

}  // namespace splatlas
