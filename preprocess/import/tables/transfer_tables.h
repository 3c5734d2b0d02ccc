// Members of notes, and of tables of names and of trees, for archives.
#pragma once

#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

void transfer(auto& archive, Term& term) {
  archive(term.vocabulary, term.value);
}
void transfer(auto& archive, SourceStructure& structure) {
  archive(structure.name, structure.label, structure.code, structure.color, structure.external,
          structure.terms);
}
void transfer(auto& archive, NoteKind& kind) {
  archive(kind.id, kind.one, kind.many, kind.is_warning, kind.is_minor);
}
void transfer(auto& archive, Note& note) {
  archive(note.kind, note.items);
}
void transfer(auto& archive, LabelName& name) {
  transfer(archive, static_cast<SourceStructure&>(name));
  archive(name.line, name.key);
}
void transfer(auto& archive, TreeNode& node) {
  archive(node.key, node.name, node.label, node.parents);
}
void transfer(auto& archive, TreeLine& line) {
  archive(line.number, line.groups, line.member, line.color, line.node);
}
void transfer(auto& archive, NamesTable& table) {
  archive(table.dialect, table.names, table.zero_name, table.hierarchy, table.columns);
}

}  // namespace splatlas
