#include "preprocess/import/images/nifti/nifti_labels.h"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// The text between `before` and `after`, behind which `rest` then begins.
std::optional<std::string_view> cut_between(std::string_view& rest, std::string_view before,
                                            std::string_view after) {
  const std::size_t start = rest.find(before);
  if (start == std::string_view::npos) return std::nullopt;
  const std::size_t end = rest.find(after, start + before.size());
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view found = rest.substr(start + before.size(), end - start - before.size());
  rest.remove_prefix(end + after.size());
  return found;
}

/// Text of an XML element: CDATA, or text with entities.
std::string text_of(std::string_view content) {
  if (const auto data = cut_between(content, "<![CDATA[", "]]>")) return std::string(trimmed(*data));
  std::string text(trimmed(content));
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};
  for (const auto& [entity, character] : kEntities) {
    for (std::size_t at = text.find(entity); at != std::string::npos; at = text.find(entity, at + 1))
      text.replace(at, entity.size(), 1, character);
  }
  return text;
}

}  // namespace

std::vector<SourceSegment> labels_of_extensions(std::string_view extensions) {
  std::vector<SourceSegment> labels;
  auto table = cut_between(extensions, "<LabelTable", "</LabelTable>");
  if (!table) return labels;
  while (const auto label = cut_between(*table, "<Label ", "</Label>")) {
    std::string_view attributes = label->substr(0, label->find('>'));
    const std::string_view content = label->substr(std::min(attributes.size() + 1, label->size()));
    const auto key = cut_between(attributes, "Key=\"", "\"");
    const auto value = key ? parse_integer(*key) : std::nullopt;
    if (!value || *value <= 0) continue;
    SourceSegment segment;
    segment.value = *value;
    segment.structure.name = text_of(content);
    if (!segment.structure.name.empty()) labels.push_back(std::move(segment));
  }
  return labels;
}

}  // namespace splatlas
