// NiiVue's colour maps of labels: arrays R, G, B, I (label values) and labels (names).
#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/tables/color_text.h"
#include "preprocess/import/tables/json_text.h"
#include "preprocess/import/tables/names/dialects.h"

namespace splatlas {
namespace {

/// A value of an array of the map, as text; "" behind its end.
std::string value_at(const Json& map, const char* key, std::size_t n) {
  const auto list = map.find(key);
  if (list == map.end() || !list->is_array() || n >= list->size()) return {};
  return text_of((*list)[n]);
}

}  // namespace

bool recognise_niivue(std::string_view head, std::string_view /*file*/) {
  return is_json(head) && has_json_key(head, "R") && has_json_key(head, "G") && has_json_key(head, "B");
}

Result<void> read_niivue(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json map, parse_json(input));
  const auto labels = map.is_object() ? map.find("labels") : map.end();
  if (labels == map.end() || !labels->is_array()) {
    return input.refuse(
        "has no \"labels\": it is a colour ramp, which names no structures; give a map of labels");
  }
  const bool has_values = map.contains("I") && map["I"].is_array() && !map["I"].empty();
  const std::size_t count = has_values ? map["I"].size() : labels->size();
  for (std::size_t n = 0; n < count; ++n) {
    LabelName name;
    name.line = n + 1;
    name.name = value_at(map, "labels", n);
    const std::string rgb =
        fmt::format("{},{},{}", value_at(map, "R", n), value_at(map, "G", n), value_at(map, "B", n));
    name.color = parse_table_color(rgb);
    if (!name.color && rgb != ",,") into.add_bad_color(n + 1, rgb);
    into.add(has_values ? value_at(map, "I", n) : fmt::format("{}", n), std::move(name));
  }
  return {};
}

}  // namespace splatlas
