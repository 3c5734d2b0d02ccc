// Members of notes, and of tables of names and of trees, for archives.
#pragma once

#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

void transfer(auto& archive, Rgb& color) {
  archive(color.r, color.g, color.b);
}
void transfer(auto& archive, Term& term) {
  archive(term.vocabulary, term.value);
}
void transfer(auto& archive, SourceStructure& structure) {
  archive(structure.name, structure.label, structure.code, structure.color, structure.external,
          structure.terms);
}
void transfer(auto& archive, NoteKind& kind) {
  archive(kind.id, kind.one, kind.many, kind.is_warning);
}
void transfer(auto& archive, Note& note) {
  archive(note.kind, note.items);
}
void transfer(auto& archive, LabelName& name) {
  transfer(archive, static_cast<SourceStructure&>(name));
  std::uint64_t line = name.line;
  archive(line, name.key);
  name.line = static_cast<std::size_t>(line);
}
void transfer(auto& archive, ColorRange& range) {
  archive(range.first, range.last);
}
void transfer(auto& archive, TreeNode& node) {
  archive(node.key, node.name, node.label, node.parents);
}
void transfer(auto& archive, TreeLine& line) {
  std::uint64_t number = line.number;
  archive(number, line.groups, line.member, line.color, line.node);
  line.number = static_cast<std::size_t>(number);
}
void transfer(auto& archive, NamesTable& table) {
  archive(table.dialect, table.names, table.hierarchy);
}

}  // namespace splatlas
