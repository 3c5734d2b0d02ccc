// Names and trees in JSON.
#include <algorithm>
#include <set>
#include <unordered_map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/import/tables/names_collector.h"
#include "preprocess/import/tables/table.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

using Json = nlohmann::json;

/// Parses a JSON file. kFailed, with the position, for a syntax error.
Result<Json> parse_json(const NamesInput& input) {
  try {
    return Json::parse(input.text);
  } catch (const nlohmann::json::parse_error& error) {
    return input.refuse(fmt::format("byte {} is no JSON; correct it, or write the file again", error.byte));
  } catch (const nlohmann::json::exception& error) {  // for example a number beyond a double
    return input.refuse(fmt::format("is no usable JSON (error {}); write the file again", error.id));
  }
}

/// True if the first character that is no blank begins an object or a list.
bool is_json(std::string_view head) {
  const std::string_view text = trimmed(head);
  return text.starts_with('{') || text.starts_with('[');
}

bool has_json_key(std::string_view head, std::string_view key) {
  const std::string quoted = fmt::format("\"{}\"", key);
  for (std::size_t at = is_json(head) ? head.find(quoted) : head.npos; at != head.npos;
       at = head.find(quoted, at + 1)) {
    if (trimmed(head.substr(at + quoted.size(), 8)).starts_with(':')) return true;
  }
  return false;
}

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object() || value.is_null()) return {};
  if (!value.is_array()) return value.dump();
  std::string list;
  for (const Json& part : value) list += (list.empty() ? "" : ", ") + (part.is_array() ? "" : text_of(part));
  return "[" + list + "]";
}

/// A member of an object, or null.
const Json& at(const Json& object, const char* key) {
  static const Json kNull;
  return object.is_object() && object.contains(key) ? object[key] : kNull;
}

std::string text_at(const Json& object, const char* key) {
  return text_of(at(object, key));
}

Table::Row row_of(const Json& object, std::size_t number, const std::vector<std::string>& columns) {
  Table::Row row{number, {}};
  for (const std::string& column : columns) row.fields.push_back(text_at(object, column.c_str()));
  return row;
}

/// Objects as rows of a table: a list, or a map from labels.
Result<void> read_objects(const NamesInput& input, const Json& json, NamesCollector& into) {
  constexpr std::size_t kMaxObjects = 100'000, kMaxKeys = 100;
  if (json.size() > kMaxObjects) return input.refuse(fmt::format("has more than {} entries", kMaxObjects));
  std::set<std::string> keys;
  for (const Json& object : json) {
    for (const auto& [key, value] : object.items()) {
      if (object.is_object() && keys.size() < kMaxKeys) keys.insert(key);
    }
  }
  Table table{{keys.begin(), keys.end()}, {}, {}};
  std::size_t number = 0;
  for (const auto& [key, object] : json.items()) {
    ++number;
    if (!object.is_object()) {
      into.add_fault(number, "is no object");
      continue;
    }
    table.rows.push_back(row_of(object, number, table.columns));
    if (json.is_object()) table.rows.back().fields.push_back(key);
  }
  if (json.is_object()) table.columns.emplace_back("LabelValue");
  return add_table(table, input, into);
}

// Open Anatomy's atlasStructure.json: groups with members, and structures with a selector of their voxels.

/// True if "@type", text or a list, has this type.
bool has_type(const Json& object, std::string_view type) {
  const Json& types = at(object, "@type");
  if (types.is_string()) return types.get<std::string>() == type;
  return types.is_array() && std::ranges::any_of(types, [&](const Json& one) {
           return one.is_string() && one.get<std::string>() == type;
         });
}

/// An object as a list of one.
template <typename Visit>
void for_each(const Json& one_or_many, const Visit& visit) {
  if (one_or_many.is_array()) {
    for (const Json& one : one_or_many) visit(one);
  } else if (!one_or_many.is_null()) {
    visit(one_or_many);
  }
}

class OpenAnatomyReader {
 public:
  explicit OpenAnatomyReader(NamesCollector& into) : into_(into) {}

  /// The header's roots come first: they stay above their members where these name them again.
  void read(const Json& list) {
    std::set<std::string> roots;
    for (const Json& object : list) {
      add(object);
      if (has_type(object, "Header"))
        for_each(at(object, "root"), [&](const Json& root) { roots.insert(text_of(root)); });
    }
    std::stable_partition(lines_.begin(), lines_.end(),
                          [&](const TreeLine& line) { return roots.contains(line.node->key); });
    for (TreeLine& line : lines_) {
      const auto parents = parents_.find(line.node->key);
      if (parents != parents_.end()) line.node->parents = parents->second;
    }
    into_.set_hierarchy(std::move(lines_));
  }

 private:
  /// Adds a group or structure; returns its key, "" for other objects.
  std::string add(const Json& object) {
    const bool is_group = has_type(object, "Group");
    const bool is_structure = has_type(object, "Structure");
    if (!is_group && !is_structure) return {};
    const std::size_t number = lines_.size() + 1;
    TreeLine line;
    line.number = number;
    std::string key = text_at(object, "@id");
    if (key.empty()) key = fmt::format("entry {}", number);
    line.node = TreeNode{key, text_at(at(object, "annotation"), "name"), std::nullopt, {}};
    if (line.node->name.empty()) line.node->name = key;
    const std::string color = text_at(at(object, "renderOption"), "color");
    if (const auto rgb = parse_css_color(color)) {
      line.color = ColorRange{*rgb, *rgb};
    } else if (!color.empty()) {
      into_.add_note("bad-colors", number, color);
    }
    if (is_structure) add_name(object, line);
    lines_.push_back(std::move(line));
    for_each(at(object, "member"), [&](const Json& member) { add_member(key, member); });
    return key;
  }

  /// A member is an id, or the object itself.
  void add_member(const std::string& group, const Json& member) {
    const std::string key = member.is_object() ? add(member) : text_of(member);
    std::vector<std::string>& parents = parents_[key];
    if (std::ranges::find(parents, group) == parents.end()) parents.push_back(group);
  }

  void add_name(const Json& object, TreeLine& line) {
    LabelName name;
    name.line = line.number;
    name.name = line.node->name;
    if (line.color) name.color = line.color->first;
    for_each(at(object, "sourceSelector"), [&](const Json& selector) {
      if (!has_type(selector, "labelMapSelector") && !has_type(selector, "LabelMapSelector")) return;
      const std::string label = text_at(selector, "dataKey");
      if (!line.node->label) line.node->label = parse_label(label);
      if (!line.node->label) into_.add_fault(line.number, fmt::format("dataKey '{}' is no label", label));
    });
    name.label = line.node->label;
    into_.add(std::move(name));
  }

  NamesCollector& into_;
  std::vector<TreeLine> lines_;
  std::unordered_map<std::string, std::vector<std::string>> parents_;  // by key
};

// Structure graphs of the Allen Brain Atlas API: nested structures, wrapped in msg[0] or bare.

struct Nested {
  const Json* structure;
  std::string parent;  // its id
};

/// Nested structures as rows in depth-first order. The nesting tells the parent, often alone. Groups may have
/// no id: they get one that is no label.
Table flatten(const Json& roots) {
  Table table;
  table.columns = {"label", "id", "name", "acronym", "color_hex_triplet", "parent_structure_id"};
  std::vector<Nested> pending;
  const auto push_all = [&](const Json& list, const std::string& parent) {
    if (list.is_object()) pending.push_back({&list, parent});
    if (!list.is_array()) return;
    for (auto item = list.rbegin(); item != list.rend(); ++item) {
      if (item->is_object()) pending.push_back({&*item, parent});
    }
  };
  push_all(roots, "");
  while (!pending.empty()) {
    const Nested next = pending.back();
    pending.pop_back();
    Table::Row row = row_of(*next.structure, table.rows.size() + 1, table.columns);
    row.fields[0] = row.fields[1];
    if (row.fields[1].empty()) row.fields[1] = fmt::format("entry {}", row.line);
    row.fields.back() = next.parent;
    push_all(at(*next.structure, "children"), row.fields[1]);
    table.rows.push_back(std::move(row));
  }
  return table;
}

// NiiVue's colour maps of labels: arrays R, G, B, I (label values) and labels (names).

/// A value of an array of the map, as text; "" behind its end.
std::string value_at(const Json& map, const char* key, std::size_t n) {
  const Json& list = at(map, key);
  return list.is_array() && n < list.size() ? text_of(list[n]) : std::string();
}

Result<void> read_open_anatomy(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  if (!json.is_array())
    return input.refuse("is no list of objects; give the atlasStructure.json of an atlas");
  OpenAnatomyReader(into).read(json);
  return {};
}

Result<void> read_allen(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  const bool is_answer = json.is_object() && json.contains("msg");
  const Table table = flatten(is_answer ? json["msg"] : json);
  if (table.rows.empty()) return input.refuse("holds no structures; download the structure graph again");
  return add_table(table, input, into);
}

// dcmqi's description of a DICOM segmentation: lists of segments, one a file.

Result<void> read_dcmqi(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  Table table;
  table.columns = {"labelID", "SegmentLabel", "SegmentDescription", "recommendedDisplayRGBValue"};
  const std::vector<std::string> codes{"CodingSchemeDesignator", "CodeValue"};
  for_each(at(json, "segmentAttributes"), [&](const Json& file) {
    for_each(file, [&](const Json& segment) {
      Table::Row row = row_of(segment, table.rows.size() + 1, table.columns);
      if (row.fields[1].empty()) row.fields[1] = row.fields[2];
      for (std::string& code : row_of(at(segment, "SegmentedPropertyTypeCodeSequence"), 0, codes).fields)
        row.fields.push_back(std::move(code));
      table.rows.push_back(std::move(row));
    });
  });
  table.columns = {"label", "name", "visible", "rgb", "type_codingscheme", "type_codevalue"};
  return add_table(table, input, into);
}

// Class maps of programs that segment: {"1": "spleen"}, {"spleen": 1}, either also below "labels".

Result<void> read_json_map(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  const bool is_wrapped = json.is_object() && json.contains("labels") && json["labels"].is_object();
  const Json& map = is_wrapped ? json["labels"] : json;
  if (!map.empty() && map.front().is_object()) return read_objects(input, map, into);  // also BrainGlobe's
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

Result<void> read_niivue(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json map, parse_json(input));
  const auto labels = map.is_object() ? map.find("labels") : map.end();
  if (labels == map.end() || !labels->is_array()) {
    return input.refuse(
        "has no \"labels\": it is a colour ramp, which names no structures; give a map of labels");
  }
  const bool has_values = map.contains("I") && map["I"].is_array() && !map["I"].empty();
  const std::size_t count = has_values ? map["I"].size() : labels->size();
  Table table{{"label", "name", "r", "g", "b"}, {}, {}};
  for (std::size_t n = 0; n < count; ++n) {
    table.rows.push_back({n + 1, {has_values ? value_at(map, "I", n) : fmt::format("{}", n)}});
    for (const char* key : {"labels", "R", "G", "B"}) table.rows[n].fields.push_back(value_at(map, key, n));
  }
  return add_table(table, input, into);
}

}  // namespace

const Dialect kOpenAnatomyNames{{NamesFormat::kOpenAnatomy, "openanatomy", "Open Anatomy atlas"},
                                [](std::string_view head) {
                                  return has_json_key(head, "@type") &&
                                         (head.find("\"Header\"") != std::string_view::npos ||
                                          head.find("\"Structure\"") != std::string_view::npos);
                                },
                                read_open_anatomy};
const Dialect kAllenNames{{NamesFormat::kAllen, "allen", "Allen structure graph"},
                          [](std::string_view head) {
                            return has_json_key(head, "children") &&
                                   (has_json_key(head, "id") || has_json_key(head, "name"));
                          },
                          read_allen};
const Dialect kBrainGlobeNames{{NamesFormat::kBrainGlobe, "brainglobe", "BrainGlobe structures"},
                               [](std::string_view head) { return has_json_key(head, "structure_id_path"); },
                               read_json_map};
const Dialect kDcmqiNames{{NamesFormat::kDcmqi, "dcmqi", "description of a DICOM segmentation"},
                          [](std::string_view head) { return has_json_key(head, "segmentAttributes"); },
                          read_dcmqi};
const Dialect kJsonNames{{NamesFormat::kJson, "json", "JSON class map"}, is_json, read_json_map};
const Dialect kNiivueNames{{NamesFormat::kNiivue, "niivue", "NiiVue colour map"},
                           [](std::string_view head) {
                             return has_json_key(head, "R") && has_json_key(head, "G") &&
                                    has_json_key(head, "B");
                           },
                           read_niivue};

Result<std::vector<TreeLine>> read_json_tree(const NamesInput& input, NamesCollector& into) {
  const std::string_view head = std::string_view(input.text).substr(0, kNamesHeadBytes);
  for (const Dialect* dialect : {&kOpenAnatomyNames, &kBrainGlobeNames, &kAllenNames}) {
    if (!dialect->recognise(head)) continue;
    SPLATLAS_RETURN_IF_ERROR(dialect->read(input, into));
    SPLATLAS_ASSIGN_OR_RETURN(NamesTable table, into.finish());
    return std::move(table.hierarchy);
  }
  return input.refuse("is no tree of the Allen Brain Atlas, of BrainGlobe or of Open Anatomy; give one");
}

}  // namespace splatlas
