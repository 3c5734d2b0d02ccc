// Class maps of programs that segment: {"1": "spleen"}, {"spleen": 1}, either also below "labels".
#include <algorithm>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/json_text.h"
#include "preprocess/import/tables/names/dialects.h"

namespace splatlas {

bool recognise_json_map(std::string_view head, std::string_view /*file*/) {
  return is_json(head);
}

Result<void> read_json_map(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  const bool is_wrapped = json.is_object() && json.contains("labels") && json["labels"].is_object();
  const Json& map = is_wrapped ? json["labels"] : json;
  const auto is_pair = [](const auto& item) {
    return item.value().is_string() || (item.value().is_number() && !parse_label(item.key()));
  };
  const auto items = map.items();
  if (!map.is_object() || !std::any_of(items.begin(), items.end(), is_pair)) {
    return input.refuse("is no map of labels and names such as {\"1\": \"spleen\"}; give one, or a table");
  }
  std::size_t number = 0;
  for (const auto& [key, value] : items) {
    LabelName name;
    name.line = ++number;
    const bool label_first = parse_label(key).has_value();
    if (value.is_structured() || value.is_null()) {
      into.add_fault(number, fmt::format("{} has no single value", in_quotes(key)));
      continue;
    }
    name.name = label_first ? text_of(value) : key;
    into.add(label_first ? key : text_of(value), std::move(name));
  }
  return {};
}

}  // namespace splatlas
