// Nodes of a table's rows: parents by id, abbreviation or name, and paths of ids or names.
#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/structure_name.h"
#include "preprocess/import/tables/table_entries.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// An id as a key: "9003.0" is 9003.
std::string key_of_id(std::string_view id) {
  const auto label = parse_label(trimmed(id));
  return "id:" + (label ? fmt::format("{}", *label) : name_key(id));
}

/// The parts of "/997/8/", "[997, 8]" or "Brain/Left".
std::vector<std::string> parts_of(std::string_view path) {
  path = trimmed(path);
  const bool is_list = path.starts_with('[') && path.ends_with(']');
  if (is_list) path = path.substr(1, path.size() - 2);
  std::vector<std::string> parts;
  for (const std::string_view part : split(path, is_list ? ',' : '/')) {
    if (!part.empty()) parts.emplace_back(part);
  }
  return parts;
}

class HierarchyMaker {
 public:
  explicit HierarchyMaker(const TableEntries& entries) : entries_(entries.entries) {}

  std::vector<TreeLine> make() {
    for (std::size_t n = 0; n < entries_.size(); ++n) keys_.push_back(claim_key(n));
    for (std::size_t n = 0; n < entries_.size(); ++n) register_path(n);
    for (std::size_t n = 0; n < entries_.size(); ++n) add(n);
    return std::move(lines_);
  }

 private:
  std::string claim_key(std::size_t n) {
    const TableEntry& entry = entries_[n];
    std::string key = entry.key.empty() ? "" : key_of_id(entry.key);
    if (key.empty() || !entry_of_key_.emplace(key, n).second) {
      key = fmt::format("row:{}", n);
      entry_of_key_.emplace(key, n);
    }
    key_of_name_.emplace(name_key(entry.name.name), key);
    for (const SourceTerm& term : entry.name.terms) {
      if (term.vocabulary == "abbreviation")
        key_of_name_.emplace("abbreviation:" + name_key(term.value), key);
    }
    return key;
  }

  /// Names of the path to an entry, itself included. Empty for paths of ids.
  [[nodiscard]] std::vector<std::string> names_of_path(std::size_t n) const {
    const TableEntry& entry = entries_[n];
    std::vector<std::string> parts = parts_of(entry.path);
    if (parts.empty() || (!entry.key.empty() && key_of_id(parts.back()) == key_of_id(entry.key))) return {};
    if (name_key(parts.back()) != name_key(entry.name.name)) parts.push_back(entry.name.name);
    return parts;
  }

  static std::string path_key(std::span<const std::string> parts) {
    std::string key = "path:";
    for (const std::string& part : parts) key += name_key(part) + "/";
    return key;
  }

  void register_path(std::size_t n) {
    const std::vector<std::string> parts = names_of_path(n);
    if (!parts.empty()) key_of_path_.emplace(path_key(parts), keys_[n]);
  }

  void add(std::size_t n) {
    const TableEntry& entry = entries_[n];
    TreeNode node{keys_[n], entry.name.name, parse_label(entry.label), {}};
    if (node.label == 0) return;  // background
    const std::string parent = parent_of(n);
    if (!parent.empty() && parent != node.key) node.parents.push_back(parent);
    if (node.name.empty() && node.label) node.name = fmt::format("Label {}", *node.label);
    TreeLine line;
    line.number = entry.name.line;
    if (entry.name.color) line.color = ColorRange{*entry.name.color, *entry.name.color};
    line.node = std::move(node);
    lines_.push_back(std::move(line));
  }

  /// The key of the parent; "" for a root.
  std::string parent_of(std::size_t n) {
    const TableEntry& entry = entries_[n];
    if (!entry.parent.empty()) return find_parent(entry.parent, entry.name.line);
    const std::vector<std::string> names = names_of_path(n);
    if (!names.empty()) return find_group(std::span(names).first(names.size() - 1), entry.name.line);
    const std::vector<std::string> ids = parts_of(entry.path);
    return ids.size() < 2 ? "" : find_parent(ids[ids.size() - 2], entry.name.line);
  }

  std::string find_parent(const std::string& text, std::size_t line) {
    if (std::string key = key_of_id(text); entry_of_key_.contains(key)) return key;
    for (const std::string& key : {"abbreviation:" + name_key(text), name_key(text)}) {
      if (const auto found = key_of_name_.find(key); found != key_of_name_.end()) return found->second;
    }
    // An id that no entry has: build_graph() counts it.
    return parse_integer(text) ? key_of_id(text) : find_group({&text, 1}, line);
  }

  /// The group of a path of names, made at its first use.
  std::string find_group(std::span<const std::string> parts, std::size_t line) {
    std::string parent;
    for (std::size_t n = 1; n <= parts.size(); ++n) {
      const std::string path = path_key(parts.first(n));
      const auto [found, is_new] = key_of_path_.emplace(path, path);
      if (is_new) {
        TreeLine group;
        group.number = line;
        group.node = TreeNode{path, parts[n - 1], std::nullopt, {}};
        if (!parent.empty()) group.node->parents.push_back(parent);
        lines_.push_back(std::move(group));
      }
      parent = found->second;
    }
    return parent;
  }

  std::span<const TableEntry> entries_;
  std::vector<std::string> keys_;  // [entry]
  std::unordered_map<std::string, std::size_t> entry_of_key_;
  std::unordered_map<std::string, std::string> key_of_name_;
  std::unordered_map<std::string, std::string> key_of_path_;
  std::vector<TreeLine> lines_;
};

}  // namespace

std::vector<TreeLine> hierarchy_of(const TableEntries& entries) {
  return HierarchyMaker(entries).make();
}

}  // namespace splatlas
