#include "preprocess/import/read_tables.h"

#include <utility>

#include "format/result_macros.h"
#include "preprocess/import/isolation/run_isolated.h"
#include "preprocess/import/tables/transfer_tables.h"

namespace splatlas {
namespace {

/// A table, and the notes of its reader.
template <typename Table>
struct NotedTable {
  Table table;
  Notes notes;
  friend void transfer(auto& archive, NotedTable& noted) { archive(noted.table, noted.notes); }
};

template <typename Table, typename Read>
Result<Table> read_in_child(const std::filesystem::path& path, Notes& notes, const Read& read) {
  SPLATLAS_ASSIGN_OR_RETURN(NotedTable<Table> noted,
                            run_isolated<NotedTable<Table>>(path, [&]() -> Result<NotedTable<Table>> {
                              NotedTable<Table> result;
                              SPLATLAS_ASSIGN_OR_RETURN(result.table, read(result.notes));
                              return result;
                            }));
  notes.add(noted.notes);
  return std::move(noted.table);
}

}  // namespace

Result<NamesTable> read_names_isolated(const std::filesystem::path& path, NamesFormat format, Notes& notes) {
  return read_in_child<NamesTable>(path, notes,
                                   [&](Notes& found) { return read_names(path, format, found); });
}

Result<std::vector<TreeLine>> read_tree_isolated(const std::filesystem::path& path, Notes& notes) {
  return read_in_child<std::vector<TreeLine>>(path, notes,
                                              [&](Notes& found) { return read_tree(path, found); });
}

}  // namespace splatlas
