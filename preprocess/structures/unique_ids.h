// Unique ids of structures.
#pragma once

#include <string>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "format/content/structure_graph.h"
#include "format/text/ascii_text.h"

namespace splatlas {

/// Gives ids from names: "Thalamus", and "Thalamus_2" if that is taken. The order of calls decides.
class UniqueIds {
 public:
  std::string claim(const std::string& name) {
    const std::string base = id_from_name(name);
    std::string id = base;
    int& number = next_number_[to_lower(base)];
    if (number == 0) number = 2;
    while (!taken_.insert(to_lower(id)).second) id = fmt::format("{}_{}", base, number++);
    return id;
  }

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, int> next_number_;
};

}  // namespace splatlas
