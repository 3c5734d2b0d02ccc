// Names files: their dialects and content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/import/tables/source_structure.h"
#include "preprocess/import/tables/tree_line.h"

namespace splatlas {

/// Dialect of a names file; kAuto: by its content.
enum class NamesFormat : std::uint8_t {
  kAuto,
  kItkSnap,      ///< label R G B A visible mesh "name"
  kCtbl,         ///< 3D Slicer's colour table: index name R G B A
  kFreeSurfer,   ///< colour lookup table: id name R G B A
  kBids,         ///< _dseg.tsv: index, name and other columns
  kMricron,      ///< label name [code]
  kNiivue,       ///< JSON arrays R G B I and labels
  kCsv,          ///< columns by name, or label,name
  kAllen,        ///< JSON tree of id, name, acronym and children
  kBrainGlobe,   ///< structures.json: a list with structure_id_path
  kOpenAnatomy,  ///< atlasStructure.json
  kJson,         ///< class map: {"1": "spleen"} or {"spleen": 1}
};

/// A dialect as a command line and a message know it.
struct NamesFormatInfo {
  NamesFormat format;
  const char* option;  ///< value of --names-format
  const char* title;   ///< for people
};

/// All dialects but kAuto, in the order of their detection.
[[nodiscard]] std::span<const NamesFormatInfo> names_formats();

/// A structure from a line of a names file. Without a label, it describes the structure with its name.
struct LabelName : SourceStructure {
  std::size_t line = 0;  ///< line or entry number in the file, for messages
  std::string key;       ///< id of the row; masks may be called so; empty if there is none
};

/// Content of a names file.
struct NamesTable {
  NamesFormat dialect = NamesFormat::kAuto;
  std::vector<LabelName> names;     ///< labels from 1 to 2^32 - 1, each once; label 0 is background
  std::vector<TreeLine> hierarchy;  ///< nodes; empty if the file has none
};

}  // namespace splatlas
