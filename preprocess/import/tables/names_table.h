// Structures of sources, the content of names files and trees, and their readers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/color.h"
#include "format/content/structure_graph.h"
#include "format/result.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// The vocabulary of a coding scheme of DICOM: "SNOMED" for SCT, else the scheme itself.
[[nodiscard]] inline std::string vocabulary_of(std::string_view scheme) {
  return scheme == "SCT" ? "SNOMED" : std::string(scheme);
}

/// A structure before its placement in the graph. Its index in the list of these is its source number.
struct SourceStructure {
  std::string name;
  std::optional<std::int64_t> label = {};
  std::optional<std::int64_t> code = {};  ///< of the region, such as AAL's third column
  std::optional<Rgb> color = {};
  bool external = false;
  std::vector<Term> terms = {};              ///< in the order of the source
  std::string group = {};                    ///< of its label map: a root that it is below; empty for none
  std::optional<StructureIndex> whole = {};  ///< source number of the structure that it is a side of
};

/// Colours interpolated linearly over the structures of a line; both are equal for a single colour.
struct ColorRange {
  Rgb first, last;
};

/// A structure or group of a table or JSON file, known by a key of its own.
struct TreeNode {
  std::string key;  ///< unique in the file
  std::string name;
  std::optional<std::int64_t> label;  ///< identifies the structure; else its name does
  std::vector<std::string> parents;   ///< keys; empty for a root
};

/// One line of a tree: a path of a tree file, or a node.
struct TreeLine {
  std::size_t number = 0;           ///< line or entry of the file, from 1
  std::vector<std::string> groups;  ///< from the root
  std::string member;               ///< structure, pattern, "code:...", "#17" or group; empty for groups only
  std::optional<ColorRange> color;
  std::optional<TreeNode> node;  ///< replaces groups and member
};

/// Dialect of a names file; kAuto: by its content.
enum class NamesFormat : std::uint8_t {
  kAuto,
  kItkSnap,      ///< label R G B A visible mesh "name"
  kCtbl,         ///< 3D Slicer's colour table: index name R G B A
  kFreeSurfer,   ///< colour lookup table: id name R G B A
  kFslEyes,      ///< label R G B name
  kFsl,          ///< FSL's atlas in XML
  kDcmqi,        ///< dcmqi's JSON beside a DICOM segmentation
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
  std::vector<LabelName> names;      ///< labels from 1 to 2^32 - 1, each once; label 0 is background
  std::string zero_name;             ///< of label 0; empty if the file does not name it
  std::vector<TreeLine> hierarchy;   ///< nodes; empty if the file has none
  std::vector<std::string> columns;  ///< of a table without labels; else empty
};

/// Reads names in one of the dialects; kAuto detects it from the content. Rows with faults are dropped, and
/// the first of several rows of a label is kept: `notes` counts these by kind, and tells the dialect. Labels
/// without a name become "Label 7". kFailed if the file cannot be read, is of no known or of another dialect,
/// or if no row is usable; the message tells the first fault. Cost: linear in the file, at most 16 MiB.
[[nodiscard]] Result<NamesTable> read_names(const std::filesystem::path& path, NamesFormat format,
                                            Notes& notes);

/// Reads the lines of a tree file, or the nodes of a table or JSON file, by its content. Does not resolve
/// names. `notes` tells the format of tables, and counts their faults. kFailed with file and line of the
/// first fault of a tree file, and for tables without a usable row. Cost: linear in the file, at most 16 MiB.
[[nodiscard]] Result<std::vector<TreeLine>> read_tree(const std::filesystem::path& path, Notes& notes);

}  // namespace splatlas
