// Open Anatomy's atlasStructure.json: groups with members, and structures with a selector of their voxels.
#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/tables/color_text.h"
#include "preprocess/import/tables/json_text.h"
#include "preprocess/import/tables/names/dialects.h"

namespace splatlas {
namespace {

/// True if "@type", text or a list, has this type.
bool has_type(const Json& object, std::string_view type) {
  if (!object.is_object() || !object.contains("@type")) return false;
  const Json& types = object["@type"];
  if (types.is_string()) return types.get<std::string>() == type;
  return types.is_array() && std::ranges::any_of(types, [&](const Json& one) {
           return one.is_string() && one.get<std::string>() == type;
         });
}

/// A member of an object, or null.
const Json& at(const Json& object, const char* key) {
  static const Json kNull;
  return object.is_object() && object.contains(key) ? object[key] : kNull;
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

  void read(const Json& list) {
    for (const Json& object : list) add(object);
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
      into_.add_bad_color(number, color);
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

}  // namespace

bool recognise_open_anatomy(std::string_view head, std::string_view /*file*/) {
  return is_json(head) && has_json_key(head, "@type") &&
         (head.find("\"Header\"") != std::string_view::npos ||
          head.find("\"Structure\"") != std::string_view::npos);
}

Result<void> read_open_anatomy(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  if (!json.is_array())
    return input.refuse("is no list of objects; give the atlasStructure.json of an atlas");
  OpenAnatomyReader(into).read(json);
  return {};
}

}  // namespace splatlas
