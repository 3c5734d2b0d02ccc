// Readers of trees, which define the hierarchy of structures, and of names and trees in a child.
#pragma once

#include <filesystem>
#include <vector>

#include "format/result.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Description of the tree file format, for --help and for the head of tree files.
inline constexpr const char* kTreeFormat =
    R"(One path per line, parts joined by "/":
  Brain/Left hemisphere/Precentral_L     a structure below two groups
  Brain/Frontal lobe/Precentral_L        ... and below another group: it then has two parents
  Brain/Left hemisphere/*_L              all structures with a matching name or id, or else synonym or code
  Brain/Left hemisphere/#17              the structure with this label
  Brain/Frontal lobe/code:2001-2999      all structures with such a code in the names file (also 9100,9110)
  Brain/Left cerebrum/code:2001-8999&*_L  all structures that match both
  Brain/Cerebellum/                      a group, possibly empty
The last part selects structures, by synonyms and codes if no name or id fits. The other parts are groups, created at first use and identified by their path:
"Left/Zone 2" and "Right/Zone 2" have two groups. A last part that names exactly one group gives it another parent.
Case is ignored. Structures are numbered in the order of the file; structures that are not mentioned become roots.
Lines that fit no structure are left out.
" color=#rrggbb" at the end sets the colour of the last part; "color=#rrggbb-#rrggbb" interpolates between two
colours over several structures. Blank lines and lines that start with "#" are ignored.
Also read: tables (CSV, TSV) with columns such as id, name and parent, or path; JSON of the Allen Brain Atlas, of
BrainGlobe (structures.json) and of Open Anatomy (atlasStructure.json).)";

/// Reads the lines of a tree file, or the nodes of a table or JSON file, by its content. Does not resolve
/// names. `notes` tells the format of tables, and counts their faults. kFailed with file and line of the
/// first fault of a tree file, and for tables without a usable row. Cost: linear in the file, at most 16 MiB.
[[nodiscard]] Result<std::vector<TreeLine>> read_tree(const std::filesystem::path& path, Notes& notes);

/// read_names() and read_tree() in a child, so that no file brings this process down (run_isolated.h).
[[nodiscard]] Result<NamesTable> read_names_isolated(const std::filesystem::path& path, NamesFormat format,
                                                     Notes& notes);
[[nodiscard]] Result<std::vector<TreeLine>> read_tree_isolated(const std::filesystem::path& path,
                                                               Notes& notes);

}  // namespace splatlas
