#include "preprocess/import/images/itk/nrrd_segments.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Three numbers from 0 to 1.
std::optional<Rgb> color_of(const std::string& text) {
  const std::vector<std::string_view> parts = split_blanks(text);
  if (parts.size() != 3) return std::nullopt;
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto value = parse_number(parts[n]);
    if (!value || !(*value >= 0 && *value <= 1)) return std::nullopt;
    rgb[n] = static_cast<std::uint8_t>(std::lround(255 * *value));
  }
  return Rgb{rgb[0], rgb[1], rgb[2]};
}

/// A code "scheme^value^meaning"; nothing if it is empty.
void add_code(std::string_view code, const char* prefix, std::vector<Term>& terms) {
  const std::vector<std::string_view> parts = split(code, '^');
  if (parts.size() != 3 || parts[0].empty() || parts[1].empty()) return;
  terms.push_back({prefix + vocabulary_of(parts[0]), std::string(parts[1])});
}

/// Terms of "TerminologyEntry:context~category~type~modifier~...|key:value|...".
std::vector<Term> terms_of(const std::string& tags) {
  std::vector<Term> terms;
  constexpr std::string_view kEntry = "TerminologyEntry:";
  for (const std::string_view tag : split(tags, '|')) {
    if (!tag.starts_with(kEntry)) continue;
    const std::vector<std::string_view> parts = split(tag.substr(kEntry.size()), '~');
    if (parts.size() > 2) add_code(parts[2], "", terms);
    if (parts.size() > 3) add_code(parts[3], "modifier ", terms);
  }
  return terms;
}

}  // namespace

std::vector<SourceSegment> segments_of_nrrd(const std::map<std::string, std::string>& pairs) {
  std::vector<SourceSegment> segments;
  for (std::size_t n = 0; pairs.contains(fmt::format("Segment{}_ID", n)); ++n) {
    const auto get = [&](const char* key) {
      const auto found = pairs.find(fmt::format("Segment{}_{}", n, key));
      return found == pairs.end() ? std::string() : found->second;
    };
    SourceSegment segment;
    segment.value = parse_integer(get("LabelValue")).value_or(1);
    segment.layer = static_cast<std::size_t>(std::max<std::int64_t>(
        parse_integer(get("Layer")).value_or(get("LabelValue").empty() ? static_cast<std::int64_t>(n) : 0),
        0));
    const std::string name = get("Name");
    segment.structure.name = name.empty() ? get("ID") : name;
    segment.structure.color = color_of(get("Color"));
    segment.structure.terms = terms_of(get("Tags"));
    segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace splatlas
