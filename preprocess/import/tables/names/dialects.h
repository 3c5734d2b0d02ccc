// The readers of the dialects of names files; read_names.cpp has the table of them.
#pragma once

#include <string_view>
#include <vector>

#include "preprocess/import/tables/names_collector.h"

namespace splatlas {

/// Bytes of a file that recognise_...() sees.
inline constexpr std::size_t kNamesHeadBytes = 64 << 10;

// recognise_...(head): whether the content is of this dialect, by the first bytes of a file. The order of the
// table decides between several. They never fail.
//
// read_...(input, collector): adds the rows. An error means that nothing of the file is usable.

// Lists (read_lists.cpp).
[[nodiscard]] bool recognise_itk_snap(std::string_view head);
[[nodiscard]] Result<void> read_itk_snap(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_fsleyes(std::string_view head);
[[nodiscard]] Result<void> read_fsleyes(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_ctbl(std::string_view head);
[[nodiscard]] Result<void> read_ctbl(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_freesurfer(std::string_view head);
[[nodiscard]] Result<void> read_freesurfer(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_mricron(std::string_view head);
[[nodiscard]] Result<void> read_mricron(const NamesInput& input, NamesCollector& into);

// Tables with columns (read_columns.cpp).
[[nodiscard]] bool recognise_bids(std::string_view head);
[[nodiscard]] bool recognise_csv(std::string_view head);
[[nodiscard]] Result<void> read_csv(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_fsl(std::string_view head);
[[nodiscard]] Result<void> read_fsl(const NamesInput& input, NamesCollector& into);

// JSON (read_json.cpp).
[[nodiscard]] bool recognise_niivue(std::string_view head);
[[nodiscard]] Result<void> read_niivue(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_allen(std::string_view head);
[[nodiscard]] Result<void> read_allen(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_brainglobe(std::string_view head);
[[nodiscard]] Result<void> read_brainglobe(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_open_anatomy(std::string_view head);
[[nodiscard]] Result<void> read_open_anatomy(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_dcmqi(std::string_view head);
[[nodiscard]] Result<void> read_dcmqi(const NamesInput& input, NamesCollector& into);
[[nodiscard]] bool recognise_json_map(std::string_view head);
[[nodiscard]] Result<void> read_json_map(const NamesInput& input, NamesCollector& into);
/// The hierarchy of a JSON file of names.
[[nodiscard]] Result<std::vector<TreeLine>> read_json_tree(const NamesInput& input, NamesCollector& into);

}  // namespace splatlas
