// The readers of the dialects of names files; read_names.cpp has the table of them.
#pragma once

#include <string_view>
#include <vector>

#include "preprocess/import/tables/names_collector.h"

namespace splatlas {

/// Bytes of a file that Dialect::recognise sees.
inline constexpr std::size_t kNamesHeadBytes = 64 << 10;

/// A dialect. The order of the table in read_names.cpp decides between several that recognise a file.
struct Dialect {
  NamesFormatInfo info;
  /// True if the first bytes of a file are of this dialect.
  bool (*recognise)(std::string_view head);
  /// Adds the rows. An error means that nothing of the file is usable.
  Result<void> (*read)(const NamesInput& input, NamesCollector& into);
};

// Lists (read_lists.cpp).
extern const Dialect kItkSnapNames, kFslEyesNames, kCtblNames, kFreeSurferNames, kMricronNames;
// Tables with columns, and FSL's XML (read_columns.cpp).
extern const Dialect kBidsNames, kCsvNames, kFslNames;
// JSON (read_json.cpp).
extern const Dialect kNiivueNames, kAllenNames, kBrainGlobeNames, kOpenAnatomyNames, kDcmqiNames, kJsonNames;

/// The hierarchy of a JSON file of names.
[[nodiscard]] Result<std::vector<TreeLine>> read_json_tree(const NamesInput& input, NamesCollector& into);

}  // namespace splatlas
