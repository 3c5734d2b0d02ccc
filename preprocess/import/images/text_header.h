// Text header of an image file (NRRD, MetaImage).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "format/result.h"

namespace splatlas {

struct TextHeader {
  std::map<std::string, std::string> fields;
  std::uint64_t bytes = 0;  ///< length of the header; pixels may follow

  /// The value of a field, or `otherwise`.
  [[nodiscard]] std::string get(const std::string& field, const std::string& otherwise = "") const {
    const auto found = fields.find(field);
    return found == fields.end() ? otherwise : found->second;
  }
};

/// A line of a header.
struct HeaderLine {
  enum class Kind { kField, kLastField, kComment, kEnd } kind = Kind::kEnd;
  std::string field, value;
};

/// Reads lines until kLastField or kEnd, or to the end of the first `max_bytes`. kFailed for a field that
/// occurs twice.
[[nodiscard]] Result<TextHeader> read_text_header(const std::filesystem::path& path, std::size_t max_bytes,
                                                  HeaderLine (*parse_line)(std::string_view line));

}  // namespace splatlas
