// Contents of the golden files, and their text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/content/atlas_content.h"

namespace splatlas {

struct GoldenContent {
  std::string name;  ///< file name
  AtlasContent content;
  bool compact = false;
  std::uint64_t means_from = ~std::uint64_t{0};  ///< WriteOptions::means_from
};

/// All numbers of an atlas as plain text, stored beside golden files; equal text for equal content.
[[nodiscard]] std::string content_text(const AtlasContent& content);

/// `text` with the labels and values, a part between two headings, of `other`.
[[nodiscard]] std::string with_values_of(std::string text, const std::string& other);
/// The labels and values in `text`, if these are all that differs from the text `good`; else all of `text`.
[[nodiscard]] std::string text_beside(const std::string& good, const std::string& text);

/// Small atlases that together cover all features of the format and all value types.
[[nodiscard]] std::vector<GoldenContent> golden_contents();

}  // namespace splatlas
