// A page that plays an atlas, as one HTML file without references to others.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"
#include "player/page/annotation.h"

namespace splatlas {

struct HtmlPage {
  std::span<const std::byte> atlas = {};  ///< bytes of the file; empty: at the url, or in the server
  std::string url = {};                   ///< of the file, relative to the page, percent-encoded
  bool is_served = false;                 ///< by a PageServer, which has the engine
  std::string title;                      ///< any text; empty: a general one
  std::string caption;                    ///< any text, of the opening picture
  std::string opening;                    ///< JSON: the selection and the camera of the opening picture
  std::vector<std::byte> picture = {};    ///< the opening picture as WebP; empty: none
};

/// The bytes of the file. Texts are escaped; the content security policy allows the page's own script, style
/// and workers alone, by their SHA-256. kFailed, with the remedy, if the page is not served
/// and this program was built without the WebAssembly module. Memory: four times the atlas.
[[nodiscard]] Result<std::string> encode_html(const HtmlPage& page);

struct CatalogueEntry {
  std::string title, text;         ///< any texts
  std::string url;                 ///< of its page, percent-encoded
  std::vector<std::byte> picture;  ///< WebP
};

/// A page with a picture and a link for each atlas.
[[nodiscard]] std::string encode_catalogue(std::span<const CatalogueEntry> entries);

/// A scene in a handout: any texts, and the file of its picture beside the page.
struct HandoutEntry {
  PageTexts texts;
  std::string picture;
};

/// A page with the scenes of a lesson, to read and to print. Its policy allows its style and pictures alone.
[[nodiscard]] std::string encode_handout(const std::string& title, std::span<const HandoutEntry> entries);

/// A file name as a relative URL (RFC 3986).
[[nodiscard]] std::string percent_encoded(std::string_view name);

/// kFailed, with the remedy, if this program was built without the WebAssembly module.
[[nodiscard]] Result<void> check_web_module();

}  // namespace splatlas
